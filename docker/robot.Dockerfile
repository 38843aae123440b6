# The robot's end: ROS 2, and SmartTestudo with the extra link. Built from the checkout's root:
#   docker build --file docker/robot.Dockerfile --tag smarttestudo-robot .
ARG ROS_DISTRO=jazzy
FROM ros:${ROS_DISTRO}
ARG EXTRAS=link
RUN apt-get update \
    && apt-get install --yes --no-install-recommends python3-venv \
    && rm -rf /var/lib/apt/lists/*
COPY . /src
# What ROS 2 brings was built for NumPy 1 until Jazzy.
RUN python3 -m venv --system-site-packages /opt/testudo \
    && /opt/testudo/bin/pip install --no-cache-dir "/src[${EXTRAS}]" "numpy<2; python_version < '3.13'"
ENV HOME=/tmp ROS_LOG_DIR=/tmp/ros
USER 1000:1000
ENTRYPOINT ["/ros_entrypoint.sh", "/opt/testudo/bin/testudo"]
CMD ["run", "--help"]
