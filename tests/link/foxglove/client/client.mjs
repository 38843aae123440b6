// SPDX-FileCopyrightText: 2026 The SmartTestudo authors
// SPDX-License-Identifier: Apache-2.0
// Prints the first message of each topic, decoded as the Foxglove app decodes it, as one line of JSON.
// usage: node client.mjs PORT TOPIC…
import { parse } from "@foxglove/rosmsg";
import { MessageReader } from "@foxglove/rosmsg2-serialization";
import protocol from "@foxglove/ws-protocol";
import { WebSocket } from "ws";

const [port, ...topics] = process.argv.slice(2);
const client = new protocol.FoxgloveClient({ ws: new WebSocket(`ws://127.0.0.1:${port}`, ["foxglove.sdk.v1"]) });
const subscribed = new Map();
const decoded = {};

client.on("error", (error) => {
  throw error;
});
client.on("advertise", (channels) => {
  for (const channel of channels) {
    if (topics.includes(channel.topic)) {
      subscribed.set(client.subscribe(channel.id), channel);
    }
  }
});
client.on("message", ({ subscriptionId, data }) => {
  const channel = subscribed.get(subscriptionId);
  const reader = new MessageReader(parse(channel.schema, { ros2: true }));
  const { encoding, schemaName, schemaEncoding } = channel;
  decoded[channel.topic] ??= { encoding, schemaName, schemaEncoding, message: reader.readMessage(data) };
  if (Object.keys(decoded).length === topics.length) {
    client.close();
    const plain = (_, value) => (ArrayBuffer.isView(value) ? Array.from(value) : value);
    console.log(JSON.stringify(decoded, plain));
  }
});
