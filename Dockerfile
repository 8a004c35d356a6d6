# Sidestep on Debian 12. Runs the controller of the LWA3 unless told otherwise; docs/wire.md, "In a container".
FROM debian:12
RUN apt-get update && apt-get install -y --no-install-recommends ca-certificates git make python3
COPY . /sidestep
WORKDIR /sidestep
RUN make setup all
CMD ["build/controller", "--config", "firmware/config/lwa3.yaml"]
