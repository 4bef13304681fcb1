# tactusd in a small image, with tactus-trainer, trainctl and tactus-console.
# HAProxy, which stands before them where others can connect, is the target
# "proxy"; deploy/compose.yaml runs all. deploy/check-image.sh builds and tries
# them.
#
#   docker build -t tactusd . && docker run --rm -p 127.0.0.1:50051:50051 tactusd
#   docker run --rm --entrypoint trainctl tactusd --help
#
# TLS: mount the PEM files and set TACTUSD_TLS_CERT and TACTUSD_TLS_KEY. The
# server and the health check below both read these variables; the flags
# --tls-cert and --tls-key would reach the server only.

FROM debian:bookworm-slim AS proxy
COPY deploy/install-deps.sh /deploy/
RUN /deploy/install-deps.sh --proxy \
 && rm -rf /var/lib/apt/lists/* /var/cache/apt/* /var/cache/debconf/*-old \
           /var/log/dpkg.log /var/log/apt /deploy
COPY deploy/haproxy.cfg deploy/haproxy-console.cfg /etc/haproxy/
RUN haproxy -c -f /etc/haproxy/haproxy.cfg -f /etc/haproxy/haproxy-console.cfg
USER haproxy
EXPOSE 50051 8080
ENTRYPOINT ["haproxy", "-f", "/etc/haproxy/haproxy.cfg"]

FROM debian:bookworm-slim AS page
COPY deploy/install-deps.sh /deploy/
RUN /deploy/install-deps.sh --page
COPY tools/console/page /page
RUN /page/build.sh /share/tactus/console /tmp/page

FROM debian:bookworm-slim AS build
# Where the sources lie, and further options of CMake; the check sets both, so
# that what the tests have compiled already need not be compiled again.
ARG SOURCE=/src
ARG CMAKE_OPTIONS=
COPY deploy/install-deps.sh /deploy/
RUN /deploy/install-deps.sh --build
COPY CMakeLists.txt ${SOURCE}/
COPY cmake ${SOURCE}/cmake
COPY proto ${SOURCE}/proto
COPY core ${SOURCE}/core
COPY server ${SOURCE}/server
COPY client ${SOURCE}/client
COPY tools ${SOURCE}/tools
RUN cmake -S ${SOURCE} -B ${SOURCE}/build/release -G Ninja \
      -DCMAKE_BUILD_TYPE=Release -DTACTUS_BUILD_TESTS=OFF ${CMAKE_OPTIONS} \
 && cmake --build ${SOURCE}/build/release \
      --target tactusd tactus-trainer trainctl tactus-console \
 && install -d /programs \
 && cd ${SOURCE}/build/release/bin \
 && install -s tactusd tactus-trainer trainctl tactus-console /programs/

FROM debian:bookworm-slim AS tactusd
COPY deploy/install-deps.sh /deploy/
# OpenCV's core asks for OpenGL. Its drivers, with a compiler of their own, are 48
# of 150 MB, and nothing here opens a screen.
RUN /deploy/install-deps.sh --runtime \
 && dpkg --purge --force-depends libgl1-mesa-dri libllvm15 libz3-4 libxml2 \
         libicu72 2>/dev/null \
 && rm -rf /var/lib/apt/lists/* /var/cache/apt/* /var/cache/debconf/*-old \
           /var/log/dpkg.log /var/log/apt /deploy \
 && useradd --uid 10001 --user-group --no-create-home \
            --shell /usr/sbin/nologin tactus \
 && install -d -o 10001 -g 10001 /data
COPY --from=build /programs/ /usr/local/bin/
COPY --from=page /share/ /usr/local/share/
# Fails here, not in the field, when a shared library is missing.
RUN for program in tactusd tactus-trainer trainctl tactus-console; do \
      $program --help >/dev/null || exit 1; done
VOLUME /data
USER 10001:10001
EXPOSE 50051
HEALTHCHECK --interval=10s --timeout=5s --start-period=5s --retries=3 \
  CMD ["tactusd", "--health-check=localhost:50051"]
ENTRYPOINT ["tactusd"]
CMD ["--listen=0.0.0.0:50051", "--data-dir=/data"]
