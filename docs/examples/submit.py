#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Renders a scene on a farm, by gRPC alone: uploads its files, submits a job, watches it and saves the image.

    submit.py HOST:PORT SCENE.json IMAGE.png [--spp N]

The bundle has all files in the folder of the scene. Needs Debian's python3-grpcio, and the protocol as Python:

    protoc -I proto --python_out=STUBS --grpc_python_out=STUBS \\
      --plugin=protoc-gen-grpc_python="$(command -v grpc_python_plugin)" proto/tessera/v1/*.proto
    PYTHONPATH=STUBS docs/examples/submit.py 127.0.0.1:7420 scenes/cornell/scene.json cornell.png
"""
import argparse
import hashlib
import pathlib
import sys
import uuid

import grpc
from tessera.v1 import render_service_pb2 as service
from tessera.v1 import render_service_pb2_grpc as stubs
from tessera.v1 import types_pb2 as types

CHUNK_BYTES = 1 << 20
FORMATS = {".png": service.IMAGE_FORMAT_PNG, ".exr": service.IMAGE_FORMAT_EXR,
           ".hdr": service.IMAGE_FORMAT_HDR, ".pfm": service.IMAGE_FORMAT_PFM}
ENDED = (types.JOB_STATE_DONE, types.JOB_STATE_CANCELLED, types.JOB_STATE_FAILED)


def digest_of(data):
    return types.Digest(sha256=hashlib.sha256(data).digest(), size_bytes=len(data))


def read_bundle(scene):
    """The bundle of a scene file, and the bytes of its files by SHA-256."""
    files = [path for path in scene.parent.rglob("*") if path.is_file()]
    bundle, blobs = types.Bundle(scene_path=scene.name), {}
    for name, path in sorted((path.relative_to(scene.parent).as_posix(), path) for path in files):
        data = path.read_bytes()
        asset = bundle.assets.add(path=name, digest=digest_of(data))
        blobs[asset.digest.sha256] = data
    return bundle, blobs


def chunks_of(data):
    """An upload: the first message names the blob, and an empty blob has one message."""
    for begin in range(0, max(len(data), 1), CHUNK_BYTES):
        chunk = types.BlobChunk(data=data[begin:begin + CHUNK_BYTES])
        if begin == 0:
            chunk.digest.CopyFrom(digest_of(data))
        yield service.UploadBlobRequest(chunk=chunk)


def submit(farm, scene, spp, metadata):
    bundle, blobs = read_bundle(scene)
    asked = service.FindMissingBlobsRequest(digests=[asset.digest for asset in bundle.assets])
    for digest in farm.FindMissingBlobs(asked, metadata=metadata, wait_for_ready=True).missing:
        farm.UploadBlob(chunks_of(blobs[digest.sha256]), metadata=metadata)
    # The same request_id again, after a lost answer, is the same job.
    request = service.SubmitJobRequest(request_id=str(uuid.uuid4()), bundle=bundle)
    if spp:
        request.overrides.spp = spp
    return farm.SubmitJob(request, metadata=metadata).job.id


def watch(farm, job_id, metadata):
    """Prints the progress. Returns the job at its end; the stream is opened again if it breaks."""
    while True:
        try:
            for update in farm.WatchJob(service.WatchJobRequest(job_id=job_id), metadata=metadata,
                                        wait_for_ready=True):
                job = update.job
                state = types.JobState.Name(job.state).removeprefix("JOB_STATE_")
                print(f"{job_id}: {state}, {job.samples_done} of {job.samples_total} samples", flush=True)
                if job.state in ENDED:
                    return job
        except grpc.RpcError as error:
            if error.code() not in (grpc.StatusCode.UNAVAILABLE, grpc.StatusCode.CANCELLED):
                raise


def save_image(farm, job_id, path, metadata):
    request = service.GetImageRequest(job_id=job_id, format=FORMATS[path.suffix])
    with open(path, "wb") as file:
        for response in farm.GetImage(request, metadata=metadata):
            file.write(response.data)


def channel_to(options):
    if not options.ca:
        return grpc.insecure_channel(options.address)
    read = lambda path: pathlib.Path(path).read_bytes() if path else None
    return grpc.secure_channel(options.address, grpc.ssl_channel_credentials(
        read(options.ca), read(options.key), read(options.certificate)))


def parse_options():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("address", metavar="HOST:PORT")
    parser.add_argument("scene", type=pathlib.Path)
    parser.add_argument("image", type=pathlib.Path, help="its ending selects the format: " + ", ".join(FORMATS))
    parser.add_argument("--spp", type=int, help="samples per pixel, in place of the scene's")
    parser.add_argument("--ca", help="authority of the coordinator's certificate (PEM): use TLS")
    parser.add_argument("--certificate", help="own certificate (PEM)")
    parser.add_argument("--key", help="its private key (PEM)")
    parser.add_argument("--token-file", help="file whose first line is sent with every call")
    options = parser.parse_args()
    if options.image.suffix not in FORMATS:
        parser.error(f"{options.image}: the ending must be one of " + ", ".join(FORMATS))
    return options


def main():
    options = parse_options()
    metadata = []
    if options.token_file:
        token = pathlib.Path(options.token_file).read_text().splitlines()[0]
        metadata = [("authorization", "Bearer " + token)]
    try:
        with channel_to(options) as channel:
            farm = stubs.RenderServiceStub(channel)
            job_id = submit(farm, options.scene, options.spp, metadata)
            job = watch(farm, job_id, metadata)
            if job.state != types.JOB_STATE_DONE:
                return job.failure or "the job was cancelled"
            save_image(farm, job_id, options.image, metadata)
    except grpc.RpcError as error:
        return f"{error.code().name}: {error.details()}"
    return 0


if __name__ == "__main__":
    sys.exit(main())
