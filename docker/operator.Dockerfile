# The operator's end, without ROS: recordings, metrics, the Ruler; Foxglove with --network host, as it serves 127.0.0.1
# only. Built from the checkout's root:
#   docker build --file docker/operator.Dockerfile --tag smarttestudo-operator .
FROM node:22-slim AS page
COPY . /src
WORKDIR /src
RUN sh scripts/make_gui.sh

FROM python:3.12-slim
COPY --from=page /src /src
RUN pip install --no-cache-dir "/src[studio,link,metrics]" && rm -r /src
ENV HOME=/tmp
USER 1000:1000
ENTRYPOINT ["testudo"]
CMD ["receive", "--help"]
