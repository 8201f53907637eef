# The command line and the Python module in a container, from the wheel: `./scripts/wheel.sh`, then
#     docker build --tag acroscope .
#     docker run --rm --user "$(id -u):$(id -g)" --volume "$PWD:/work" acroscope run visual-servo
FROM python:3.11-slim

COPY dist/acroscope-*.whl /tmp/
# NumPy and matplotlib for notebooks; the command needs neither.
RUN for wheel in /tmp/acroscope-*.whl; do pip install --no-cache-dir "acroscope[notebook] @ file://$wheel"; done \
    && rm /tmp/acroscope-*.whl \
    && useradd --create-home --uid 1000 bench
USER 1000
WORKDIR /work
ENTRYPOINT ["acroscope"]
CMD ["--help"]
