#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""check_manifests.py [--parts] FILE...: checks manifests against the API of Kubernetes, offline: kinds, types, required and unknown
fields; and that our own rules hold: pods without privileges, probes, requests, and labels that selectors find, unless the
files are parts of a set.

Exit status 0, 1 (with what is wrong), or 77 (skipped) without Python's yaml."""

import json
import os
import re
import sys

try:
    import yaml
except ImportError:
    print("skipped: Python's yaml is not installed (Debian: python3-yaml)")
    sys.exit(77)

with open(os.path.join(os.path.dirname(os.path.abspath(__file__)), "api_types.json"), encoding="utf-8") as file:
    API = json.load(file)

# The part of KEDA's ScaledObject that we use (https://keda.sh/docs/latest/reference/scaledobject-spec/).
API["kinds"]["keda.sh/v1alpha1/ScaledObject"] = "ScaledObject"
API["types"] |= {
    "ScaledObject": {"apiVersion": "string", "kind": "string", "metadata": "V1ObjectMeta", "spec!": "ScaledObjectSpec"},
    "ScaledObjectSpec": {
        "scaleTargetRef!": "ScaleTarget", "pollingInterval": "integer", "cooldownPeriod": "integer",
        "idleReplicaCount": "integer", "minReplicaCount": "integer", "maxReplicaCount": "integer",
        "advanced": "ScaledObjectAdvanced", "triggers!": "Array<ScaleTrigger>",
    },
    "ScaleTarget": {"apiVersion": "string", "kind": "string", "name!": "string"},
    "ScaledObjectAdvanced": {"horizontalPodAutoscalerConfig": "HorizontalPodAutoscalerConfig"},
    "HorizontalPodAutoscalerConfig": {"behavior": "V2HorizontalPodAutoscalerBehavior"},
    "ScaleTrigger": {
        "type!": "string", "name": "string", "metricType": "string", "metadata!": "{ [key: string]: string; }",
        "authenticationRef": "ScaledObjectAuthentication",
    },
    "ScaledObjectAuthentication": {"name!": "string", "kind": "string"},
}
QUANTITY = re.compile(r"^[0-9.]+([EPTGMk]i?|m|e[0-9]+)?$")


def is_plain(kind, value):
    """Whether a value has a type that is no object of the API."""
    if kind == "string":
        return isinstance(value, str)
    if kind == "integer":
        return isinstance(value, int) and not isinstance(value, bool)
    if kind == "number":
        return isinstance(value, (int, float)) and not isinstance(value, bool)
    if kind == "boolean":
        return isinstance(value, bool)
    if kind == "IntOrString":
        return isinstance(value, (int, str)) and not isinstance(value, bool)
    return kind in ("any", "Date")


def check(kind, value, where):
    """The faults of a value, as lines."""
    listed = re.fullmatch(r"Array<(.+)>", kind)
    mapped = re.fullmatch(r"\{ \[key: string\]: (.+?);? \}", kind)
    if listed:
        if not isinstance(value, list):
            return [f"{where}: must be a list"]
        return [fault for i, item in enumerate(value) for fault in check(listed[1], item, f"{where}[{i}]")]
    if mapped:
        if not isinstance(value, dict):
            return [f"{where}: must be a map"]
        return [fault for key, item in value.items() for fault in check(mapped[1], item, f"{where}.{key}")]
    if kind not in API["types"]:
        return [] if is_plain(kind, value) else [f"{where}: {value!r} is no {kind}"]
    if not isinstance(value, dict):
        return [f"{where}: must be an object"]
    fields = API["types"][kind]
    faults = [f"{where}: lacks {name[:-1]}" for name in fields if name.endswith("!") and name[:-1] not in value]
    for name, item in value.items():
        field = fields.get(name, fields.get(name + "!"))
        faults += check(field, item, f"{where}.{name}") if field else [f"{where}: there is no field {name}"]
    return faults


def check_object(manifest, where):
    kind = API["kinds"].get(f"{manifest.get('apiVersion')}/{manifest.get('kind')}")
    if kind is None:
        return [f"{where}: no kind {manifest.get('kind')} of {manifest.get('apiVersion')} is known here"]
    faults = check(kind, manifest, where)
    if not manifest.get("metadata", {}).get("name"):
        faults.append(f"{where}: lacks metadata.name")
    return faults


# ---- Our own rules, for whole sets of manifests ----


def check_container(container, where):
    faults = []
    security = container.get("securityContext", {})
    if security.get("readOnlyRootFilesystem") is not True:
        faults.append(f"{where}: its root file system can be written")
    if security.get("allowPrivilegeEscalation") is not False or security.get("capabilities", {}).get("drop") != ["ALL"]:
        faults.append(f"{where}: it keeps privileges")
    if not container.get("resources", {}).get("requests"):
        faults.append(f"{where}: it requests no resources")
    for quantities in container.get("resources", {}).values():
        faults += [f"{where}: {q!r} is no quantity" for q in quantities.values() if not QUANTITY.match(str(q))]
    for probe in ("readinessProbe", "livenessProbe"):
        if probe not in container:
            faults.append(f"{where}: it has no {probe}")
        elif container[probe].get("httpGet", {}).get("path") == "/metrics":
            faults.append(f"{where}: its {probe} asks for metrics, which are there while it hangs")
    return faults


def check_pods(manifest, where):
    template = manifest["spec"]["template"]
    pod = template["spec"]
    faults = []
    if pod.get("securityContext", {}).get("runAsNonRoot") is not True:
        faults.append(f"{where}: its pods may run as root")
    if pod.get("securityContext", {}).get("seccompProfile", {}).get("type") != "RuntimeDefault":
        faults.append(f"{where}: its pods have no seccomp profile")
    if pod.get("automountServiceAccountToken") is not False:
        faults.append(f"{where}: its pods have a token for the API")
    if template["metadata"].get("annotations", {}).get("prometheus.io/scrape") != "true":
        faults.append(f"{where}: Prometheus does not find its pods")
    volumes = {volume["name"] for volume in pod.get("volumes", [])}
    volumes |= {claim["metadata"]["name"] for claim in manifest["spec"].get("volumeClaimTemplates", [])}
    for container in pod["containers"]:
        faults += check_container(container, f"{where}/{container['name']}")
        faults += [f"{where}: there is no volume {mount['name']}" for mount in container.get("volumeMounts", [])
                   if mount["name"] not in volumes]
    return faults


def selector_of(manifest):
    spec = manifest.get("spec", {})
    if manifest["kind"] == "Service":
        return spec.get("selector")
    if manifest["kind"] == "NetworkPolicy":
        return spec["podSelector"].get("matchLabels")
    return spec.get("selector", {}).get("matchLabels")


def policy_peers(manifest):
    """The selectors of a network policy's pods and peers, each with the ports that it lets in there."""
    spec = manifest["spec"]
    for rule in spec.get("ingress", []):
        yield spec["podSelector"].get("matchLabels"), rule.get("ports", [])
    for rule in spec.get("egress", []):
        for peer in rule.get("to", []):
            if "namespaceSelector" not in peer and "podSelector" in peer:
                yield peer["podSelector"].get("matchLabels"), rule.get("ports", [])


def check_ports(policy, workloads, where):
    """Ports by name are those of the pods that a network policy selects."""
    faults = []
    for selector, ports in policy_peers(policy):
        pods = [m["spec"]["template"] for m in workloads
                if selector and selector.items() <= m["spec"]["template"]["metadata"]["labels"].items()]
        known = {port.get("name") for pod in pods for c in pod["spec"]["containers"] for port in c.get("ports", [])}
        faults += [f"{where}: {policy['metadata']['name']} names port {port['port']}, which those pods have not"
                   for port in ports if isinstance(port.get("port"), str) and port["port"] not in known]
    return faults


def check_set(manifests, where):
    """Whole sets, as kustomize makes them."""
    workloads = [m for m in manifests if m["kind"] in ("Deployment", "StatefulSet")]
    faults = [fault for m in workloads for fault in check_pods(m, f"{where}: {m['metadata']['name']}")]
    labels = [m["spec"]["template"]["metadata"]["labels"] for m in workloads]
    for manifest in manifests:
        selector = selector_of(manifest)
        if selector and not any(selector.items() <= pod.items() for pod in labels):
            faults.append(f"{where}: {manifest['kind']} {manifest['metadata']['name']} selects no pods")
        if manifest["kind"] == "NetworkPolicy":
            faults += check_ports(manifest, workloads, where)
        target = manifest.get("spec", {}).get("scaleTargetRef")
        if target and target["name"] not in [m["metadata"]["name"] for m in workloads]:
            faults.append(f"{where}: {manifest['kind']} scales {target['name']}, which is not there")
        if manifest["kind"] in ("ScaledObject", "HorizontalPodAutoscaler"):
            scaled = next(m for m in workloads if m["metadata"]["name"] == target["name"])
            if "replicas" in scaled["spec"]:
                faults.append(f"{where}: {target['name']} has a number of replicas and an autoscaler")
    return faults


def main():
    faults = []
    paths = [path for path in sys.argv[1:] if path != "--parts"]
    for path in paths:
        where = os.path.relpath(path)
        with open(path, encoding="utf-8") as text:
            manifests = [m for m in yaml.safe_load_all(text) if m is not None]
        if not manifests:
            faults.append(f"{where}: there is no manifest")
        typed = [fault for m in manifests for fault in check_object(m, f"{where}: {m.get('kind')}")]
        faults += typed
        if not typed and "--parts" not in sys.argv:
            faults += check_set(manifests, where)
    print("\n".join(faults))
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
