#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""extract_api_types.py MODELS: prints api_types.json, the fields of the API of Kubernetes that deploy/kubernetes uses.

MODELS is the folder dist/gen/models of npm's package @kubernetes/client-node, which is generated from the OpenAPI
description of Kubernetes. "field!" is required. Status, which manifests do not have, is left out."""

import json
import os
import re
import sys

KINDS = {
    "v1/Namespace": "V1Namespace",
    "v1/ServiceAccount": "V1ServiceAccount",
    "v1/Service": "V1Service",
    "apps/v1/StatefulSet": "V1StatefulSet",
    "apps/v1/Deployment": "V1Deployment",
    "networking.k8s.io/v1/NetworkPolicy": "V1NetworkPolicy",
    "policy/v1/PodDisruptionBudget": "V1PodDisruptionBudget",
    "autoscaling/v2/HorizontalPodAutoscaler": "V2HorizontalPodAutoscaler",
}


def fields_of(models, name):
    with open(os.path.join(models, name + ".d.ts"), encoding="utf-8") as file:
        declared = dict(re.findall(r"^    '(.+?)'(\??): ", file.read(), re.MULTILINE))
    with open(os.path.join(models, name + ".js"), encoding="utf-8") as file:
        listed = re.findall(r'"name": "(.+?)",\s*"baseName": "(.+?)",\s*"type": "(.+?)",\s*"format": "(.*?)"', file.read())
    fields = {}
    for field, written, kind, form in listed:
        if written == "status":
            continue
        required = "" if declared[field] == "?" else "!"
        fields[written + required] = "integer" if form in ("int32", "int64") and kind == "number" else kind
    return fields


def main():
    models = sys.argv[1]
    types, waiting = {}, sorted(set(KINDS.values()))
    while waiting:
        name = waiting.pop()
        if name in types:
            continue
        types[name] = fields_of(models, name)
        for kind in types[name].values():
            waiting += [word for word in re.findall(r"\b[VA]\w+", kind) if os.path.exists(os.path.join(models, word + ".js"))]
    print('{\n"kinds": ' + json.dumps(KINDS, sort_keys=True) + ',\n"types": {')
    print(",\n".join(f'"{name}": {json.dumps(types[name], sort_keys=True)}' for name in sorted(types)))
    print("}\n}")


if __name__ == "__main__":
    main()
