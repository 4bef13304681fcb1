# tactusd in a small image. deploy/check-image.sh builds and tries it.
#
#   docker build -t tactusd . && docker run --rm -p 50051:50051 tactusd
#
# TLS: mount the PEM files and set TACTUSD_TLS_CERT and TACTUSD_TLS_KEY. The
# server and the health check below both read these variables; the flags
# --tls-cert and --tls-key would reach the server only.

FROM debian:bookworm-slim AS build
COPY deploy/install-deps.sh /deploy/
RUN /deploy/install-deps.sh --build
COPY CMakeLists.txt /src/
COPY cmake /src/cmake
COPY proto /src/proto
COPY core /src/core
COPY server /src/server
RUN cmake -S /src -B /build -G Ninja -DCMAKE_BUILD_TYPE=Release \
      -DTACTUS_BUILD_TESTS=OFF -DTACTUS_BUILD_TOOLS=OFF \
 && cmake --build /build --target tactusd tactus-trainer \
 && strip /build/bin/tactusd /build/bin/tactus-trainer

FROM debian:bookworm-slim
COPY deploy/install-deps.sh /deploy/
RUN /deploy/install-deps.sh --runtime \
 && rm -rf /var/lib/apt/lists/* /var/cache/apt/* /var/cache/debconf/*-old \
           /var/log/dpkg.log /var/log/apt /deploy \
 && useradd --uid 10001 --user-group --no-create-home \
            --shell /usr/sbin/nologin tactus \
 && install -d -o 10001 -g 10001 /data
COPY --from=build /build/bin/tactusd /build/bin/tactus-trainer /usr/local/bin/
# Fails here, not in the field, when a shared library is missing.
RUN tactusd --help >/dev/null && tactus-trainer --help >/dev/null
VOLUME /data
USER 10001:10001
EXPOSE 50051
HEALTHCHECK --interval=10s --timeout=5s --start-period=5s --retries=3 \
  CMD ["tactusd", "--health-check=localhost:50051"]
ENTRYPOINT ["tactusd"]
CMD ["--listen=0.0.0.0:50051", "--data-dir=/data"]
