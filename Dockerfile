# docker build -t cosim . && docker run --rm -v "$PWD/results:/work" cosim run midblock_zebra --out /work/run
FROM python:3.11-slim AS build
WORKDIR /source
COPY . .
RUN pip install --no-cache-dir build && python -m build --wheel --outdir /wheel

FROM python:3.11-slim
RUN apt-get update \
    && apt-get install -y --no-install-recommends libgl1 libx11-6 libxext6 libxrender1 \
    && rm -rf /var/lib/apt/lists/* \
    && useradd --create-home --uid 1000 cosim
COPY constraints.txt /tmp/constraints.txt
COPY --from=build /wheel /tmp/wheel
RUN pip install --no-cache-dir -c /tmp/constraints.txt "$(ls /tmp/wheel/*.whl)[report,cluster]" \
    && rm -r /tmp/wheel /tmp/constraints.txt
USER cosim
WORKDIR /work
ENTRYPOINT ["cosim"]
CMD ["--help"]
