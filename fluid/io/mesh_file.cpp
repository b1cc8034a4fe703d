#include "fluid/io/mesh_file.h"

#include <fmt/format.h>

#include <iterator>

#include "fluid/io/file_bytes.h"

namespace rivulet {

namespace {

constexpr MeshFormat kMeshFormatRows[] = {
    {"obj", "Wavefront OBJ: text, read by most programs", writeObj},
    {"ply", "Stanford PLY: binary, about a quarter of the size", writePly},
};
constexpr Table<MeshFormat> kMeshFormats{kMeshFormatRows};

}  // namespace

const Table<MeshFormat>& meshFormats() { return kMeshFormats; }

std::string writeObj(const MeshView& mesh, const ExportFrame& frame) {
    std::string out = fmt::format("# metres, +{} up\n", frame.upLetter());
    auto end = std::back_inserter(out);
    for (const vec3& own : mesh.positions) {
        const vec3 p = frame.turned(own);
        const dvec3 far = frame.place(own);
        if (frame.doubles())
            fmt::format_to(end, "v {} {} {}\n", far.x, far.y, far.z);
        else
            fmt::format_to(end, "v {} {} {}\n", p.x, p.y, p.z);
    }
    for (const vec3& own : mesh.normals) {
        const vec3 n = frame.turned(own);
        fmt::format_to(end, "vn {} {} {}\n", n.x, n.y, n.z);
    }
    for (size_t k = 0; k + 2 < mesh.indices.size(); k += 3) {
        const uint32_t a = mesh.indices[k] + 1, b = mesh.indices[k + 1] + 1, c = mesh.indices[k + 2] + 1;
        if (mesh.normals.empty())
            fmt::format_to(end, "f {} {} {}\n", a, b, c);
        else
            fmt::format_to(end, "f {}//{} {}//{} {}//{}\n", a, a, b, b, c, c);
    }
    return out;
}

std::string writePly(const MeshView& mesh, const ExportFrame& frame) {
    const char* type = frame.doubles() ? "double" : "float";
    std::string out = fmt::format("ply\nformat binary_little_endian 1.0\ncomment metres, +{} up\n", frame.upLetter());
    out += fmt::format("element vertex {}\nproperty {} x\nproperty {} y\nproperty {} z\n", mesh.positions.size(), type, type, type);
    if (!mesh.normals.empty()) out += "property float nx\nproperty float ny\nproperty float nz\n";
    out += fmt::format("element face {}\nproperty list uchar uint vertex_indices\nend_header\n", mesh.triangleCount());
    const size_t start = out.size();
    for (size_t i = 0; i < mesh.positions.size(); ++i) {
        putPlace(out, mesh.positions[i], frame);
        // Assimp reads a line end at the start of the data as part of the header (its issue 5341): one bit of the first number is changed.
        if (i == 0 && (out[start] == '\n' || out[start] == '\r')) out[start] = '\v';
        if (!mesh.normals.empty()) putVector(out, frame.turned(mesh.normals[i]));
    }
    for (size_t k = 0; k + 2 < mesh.indices.size(); k += 3) {
        out += '\3';
        for (size_t corner = 0; corner < 3; ++corner) putWord(out, mesh.indices[k + corner]);
    }
    return out;
}

}  // namespace rivulet
