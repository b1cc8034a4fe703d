#!/usr/bin/env python3
"""reference.py ROOT: writes docs/api.md from the headers that a host includes: the comment that each begins with, and its declarations. With
--check: exit 1 if the page differs from the headers."""
import pathlib
import re
import sys

HEADERS = [
    "engine/core/result.h", "engine/core/log.h", "engine/core/jobs.h", "engine/compute/device.h", "engine/compute/device_cpu.h", "engine/gpu/lost_context.h", "engine/gpu/load.h", "engine/gpu/host_state.h",
    "engine/render/frame_view.h", "engine/core/mesh_view.h", "fluid/voxel/voxel_field.h", "fluid/voxel/field_bake.h", "fluid/sim/solids/solids.h", "fluid/sim/solids/bodies.h",
    "fluid/sim/solids/probes.h",
    "fluid/sim/world/fluid_params.h", "fluid/sim/forces/force_*.h", "fluid/sim/methods/method_pbf.h",
    "fluid/sim/methods/method_dfsph.h", "fluid/sim/sources/block.h", "fluid/sim/sources/emitter.h", "fluid/sim/forces/force.h", "fluid/sim/world/stats.h", "fluid/sim/world/particle_view.h", "fluid/sim/world/fluid_world.h",
    "fluid/sim/query/water_query.h", "fluid/sim/solids/buoyancy.h", "fluid/sim/query/volumes.h", "fluid/sim/world/world_state.h", "fluid/render/backend.h",
    "fluid/render/fluid_view.h", "fluid/render/fluid_snapshot.h", "fluid/render/fluid_upload.h", "fluid/render/look_params.h", "fluid/render/host_target.h",
    "fluid/render/water_renderer.h", "fluid/render/renderers.h", "fluid/flow/flow_mesh.h", "fluid/flow/surface_flow.h",
    "fluid/flow/flow_maps.h", "fluid/flow/flow_layer.h", "fluid/flow/placed_flow.h", "fluid/flow/air_drops.h", "fluid/io/export.h", "fluid/io/marching_cubes.h", "fluid/io/recording.h",
    "fluid/capi/rivulet.h", "fluid/capi/rivulet_context.h", "fluid/capi/rivulet_world.h", "fluid/capi/rivulet_query.h",
    "fluid/capi/rivulet_draw.h", "fluid/capi/rivulet_skin.h", "fluid/capi/rivulet_snapshot.h",
]


def without_private(text):
    """Classes without their private members."""
    out, hidden, depth = [], None, 0
    for line in text.splitlines():
        if hidden is None and re.match(r"\s*private:$", line):
            hidden, depth = len(line) - len(line.lstrip()), 0
        if hidden is None:
            out.append(line)
        elif re.match(r"\s*};", line) and len(line) - len(line.lstrip()) < max(hidden, 1):
            hidden = None
            while out and not out[-1].strip():
                out.pop()
            out.append(line)
    return "\n".join(out)


def page(root):
    text = "# The API\n\nWritten by `fluid/capi/reference.py` from the headers that a host includes; how to use them is in [embedding.md](embedding.md).\n"
    for name in (name for pattern in HEADERS for name in (sorted(str(p.relative_to(root)) for p in root.glob(pattern)) or [pattern])):
        path = root / name
        if not path.exists():
            sys.exit(f"{name} does not exist: correct the list in fluid/capi/reference.py")
        source = path.read_text()
        if name.startswith("fluid/capi/"):
            head, body = source.split("*/", 1)
            said = "\n".join(re.sub(r"^ ?\*? ?", "", line) for line in head.replace("/*", "", 1).splitlines()).strip()
            # rivulet.h itself includes the others and declares nothing.
            body = body.split('extern "C" {\n#endif', 1)[1].split("#ifdef __cplusplus", 1)[0] if 'extern "C"' in body else ""
        else:
            lines = source.splitlines()
            n = next(k for k, line in enumerate(lines) if not line.startswith("//"))
            said = "\n".join(re.sub(r"^// ?", "", line) for line in lines[:n])
            body = "\n".join(lines[n:])
            body = re.sub(r"^#.*\n", "", body, flags=re.M)
            body = re.sub(r"^namespace [\w:]+ \{\n|^\}  // namespace [\w:]+\n?", "", body, flags=re.M)
            body = without_private(body)
        said = re.sub(r"((?:^ {4}.*\n?)+)", lambda m: "\n" + m.group(1) + "\n", said, flags=re.M)
        body = re.sub(r"\n{3,}", "\n\n", body).strip()
        language = "c" if name.startswith("fluid/capi/") else "cpp"
        text += f"\n## {name}\n\n{said.strip()}\n" + (f"\n```{language}\n{body}\n```\n" if body else "")
    return text


root = pathlib.Path(sys.argv[1])
written = page(root)
target = root / "docs/api.md"
if "--check" in sys.argv:
    if not target.exists() or target.read_text() != written:
        sys.exit("docs/api.md differs from the headers: run python3 fluid/capi/reference.py .")
else:
    target.write_text(written)
