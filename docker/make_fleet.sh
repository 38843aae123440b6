#!/bin/sh
# Makes what a fleet needs to meet at one Zenoh router: an authority, the router's certificate, a password for each
# user, and a Zenoh configuration for each machine.
# usage: docker/make_fleet.sh FOLDER ADDRESS ROBOT...
# ADDRESS is where the router is reached: an IP address or a host name. FOLDER must not exist.
# Beside the robots there are the users operator, and viewer, who may watch but change nothing.
set -eu
umask 077
days=825

refuse() { echo "$0: error: $1" >&2; exit 2; }
[ $# -ge 3 ] || refuse "it needs a folder, the router's address and the robots' names; docker/make_fleet.sh fleet 203.0.113.7 ada bob"
folder=$1 address=$2
shift 2
[ ! -e "$folder" ] || refuse "$folder is there already; name a new folder"
case $address in *[!0-9A-Za-z.:-]* | "") refuse "$address is no address" ;; esac
for robot; do
    case $robot in
        operator | viewer | router) refuse "$robot cannot be a robot's name here" ;;
        *[!0-9A-Za-z_-]* | -*) refuse "$robot: use letters, digits, _ and - in a robot's name" ;;
    esac
done
command -v openssl >/dev/null || refuse "openssl is missing; sudo apt install openssl"

case $address in
    *[!0-9.]*) case $address in *:*) name=IP:$address ;; *) name=DNS:$address ;; esac ;;
    *) name=IP:$address ;;
esac
mkdir -p "$folder/authority" "$folder/router"
# Made in a checkout, keys and passwords must not be committed with it.
echo "*" >"$folder/.gitignore"
key="-newkey ec -pkeyopt ec_paramgen_curve:P-256 -nodes"
# shellcheck disable=SC2086
openssl req -x509 $key -days "$days" -subj "/CN=fleet" \
    -keyout "$folder/authority/ca.key" -out "$folder/authority/ca.pem" 2>/dev/null
# shellcheck disable=SC2086
openssl req -x509 $key -days "$days" -subj "/CN=router" -addext "subjectAltName=$name" \
    -addext "basicConstraints=critical,CA:FALSE" -CA "$folder/authority/ca.pem" -CAkey "$folder/authority/ca.key" \
    -keyout "$folder/router/router.key" -out "$folder/router/router.pem" 2>/dev/null

member() {
    mkdir "$folder/$1"
    cp "$folder/authority/ca.pem" "$folder/$1/ca.pem"
    password=$(openssl rand -hex 24)
    echo "$1:$password" >>"$folder/router/users.txt"
    cat >"$folder/$1/zenoh.json5" <<END
{ transport: {
  link: { tls: { root_ca_certificate: "$2ca.pem" } },
  auth: { usrpwd: { user: "$1", password: "$password" } },
} }
END
}
place=${FLEET_PLACE:-}
for user in "$@" operator viewer; do member "$user" "$place"; done

# A robot may use the keys of its own name only; a viewer may ask, but change nothing.
messages='["put", "delete", "declare_subscriber", "query", "reply", "declare_queryable", "liveliness_token", "liveliness_query", "declare_liveliness_subscriber"]'
watching='["declare_subscriber", "query", "liveliness_query", "declare_liveliness_subscriber"]'
told='["put", "delete", "reply", "declare_queryable", "declare_subscriber", "liveliness_token"]'
robot_rules="" robot_subjects="" robot_policies=""
for robot; do
    robot_rules="$robot_rules
      { id: \"$robot\", permission: \"allow\", flows: [\"ingress\", \"egress\"], messages: $messages, key_exprs: [\"testudo/$robot/**\"] },"
    robot_subjects="$robot_subjects { id: \"$robot\", usernames: [\"$robot\"] },"
    robot_policies="$robot_policies { rules: [\"$robot\", \"asked\"], subjects: [\"$robot\"] },"
done
cat >"$folder/router/zenoh.json5" <<END
{
  mode: "router",
  listen: { endpoints: ["tls/0.0.0.0:7447"] },
  scouting: { multicast: { enabled: false }, gossip: { enabled: false } },
  transport: {
    link: { tls: { listen_certificate: "${place}router.pem", listen_private_key: "${place}router.key" } },
    auth: { usrpwd: { dictionary_file: "${place}users.txt" } },
  },
  access_control: {
    enabled: true,
    default_permission: "deny",
    rules: [$robot_rules
      { id: "all", permission: "allow", flows: ["ingress", "egress"], messages: $messages, key_exprs: ["testudo/**"] },
      { id: "asked", permission: "allow", flows: ["egress"], messages: $watching, key_exprs: ["testudo/**"] },
      { id: "watch", permission: "allow", flows: ["ingress"], messages: $watching, key_exprs: ["testudo/**"] },
      { id: "told", permission: "allow", flows: ["egress"], messages: $told, key_exprs: ["testudo/**"] },
      { id: "no changes", permission: "deny", flows: ["ingress"], messages: ["query"], key_exprs: ["testudo/*/*/set"] },
    ],
    subjects: [$robot_subjects { id: "operator", usernames: ["operator"] }, { id: "viewer", usernames: ["viewer"] }],
    policies: [$robot_policies
      { rules: ["all"], subjects: ["operator"] }, { rules: ["watch", "told", "no changes"], subjects: ["viewer"] },
    ],
  },
}
END
for user in router "$@" operator viewer; do echo "$folder/$user"; done
echo "Keep $folder/authority off all machines; it certifies further routers."
