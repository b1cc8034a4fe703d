#include "fluid/io/export.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <iterator>
#include <numeric>
#include <vector>

#include "fluid/io/file_bytes.h"

namespace rivulet {

namespace {

constexpr ParticleFormat kParticleFormatRows[] = {
    {"ply", "Stanford PLY: binary; for Blender, MeshLab, CloudCompare", "ply", writeParticlesPly},
    {"vtk", "VTK's XML (.vtp), and a .pvd that gives each file its time; for ParaView", "vtp", writeParticlesVtp},
    {"csv", "text, one line per particle, with units; for tables and scripts", "csv", writeParticlesCsv},
};
constexpr Table<ParticleFormat> kParticleFormats{kParticleFormatRows};

// Three bytes become four letters.
std::string base64(std::string_view bytes) {
    constexpr std::string_view kLetters = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string out;
    out.reserve((bytes.size() + 2) / 3 * 4);
    for (size_t i = 0; i < bytes.size(); i += 3) {
        uint32_t group = 0;
        for (size_t k = 0; k < 3; ++k) group = group << 8U | (i + k < bytes.size() ? static_cast<uint8_t>(bytes[i + k]) : 0U);
        for (size_t k = 0; k < 4; ++k) out += i + k <= bytes.size() ? kLetters[group >> (18 - 6 * k) & 63U] : '=';
    }
    return out;
}

// A DataArray of VTK: the number of bytes, then the bytes.
void addArray(std::string& out, std::string_view type, std::string_view name, int components, std::string_view bytes) {
    std::string whole;
    whole.reserve(bytes.size() + 8);
    putLong(whole, bytes.size());
    whole += bytes;
    fmt::format_to(std::back_inserter(out),
                   "<DataArray type=\"{}\" Name=\"{}\" NumberOfComponents=\"{}\" format=\"binary\">{}</DataArray>\n", type, name,
                   components, base64(whole));
}

std::string bytesOf(std::span<const float> numbers) {
    std::string out;
    out.reserve(numbers.size_bytes());
    for (const float x : numbers) putFloat(out, x);
    return out;
}

std::string bytesOf(std::span<const uint32_t> numbers) {
    std::string out;
    out.reserve(numbers.size_bytes());
    for (const uint32_t x : numbers) putWord(out, x);
    return out;
}

}  // namespace

const Table<ParticleFormat>& particleFormats() { return kParticleFormats; }

std::string writeParticlesPly(const ExportParticles& of, const ExportFrame& frame) {
    const char* type = frame.doubles() ? "double" : "float";
    std::string out = fmt::format(
        "ply\nformat binary_little_endian 1.0\ncomment particles at {} s, +{} up\ncomment x y z m, vx vy vz m/s, density kg/m^3, mass "
        "kg{}\n"
        "element vertex {}\n",
        of.time, frame.upLetter(), of.pressure ? ", pressure Pa" : "", of.position.size());
    for (const char axis : {'x', 'y', 'z'}) fmt::format_to(std::back_inserter(out), "property {} {}\n", type, axis);
    out += "property float vx\nproperty float vy\nproperty float vz\nproperty float density\nproperty float mass\n";
    if (of.pressure) out += "property float pressure\n";
    out += "property uint id\nend_header\n";
    std::vector<size_t> order(of.position.size());
    std::iota(order.begin(), order.end(), size_t{0});
    // Assimp reads a line end at the start of the data as part of the header (its issue 5341): another particle is written first then.
    const auto safe = std::find_if(order.begin(), order.end(), [&](size_t i) {
        std::string place;
        putPlace(place, vec3(of.position[i]), frame);
        return place[0] != '\n' && place[0] != '\r';
    });
    if (safe != order.end()) std::iter_swap(order.begin(), safe);
    for (const size_t i : order) {
        putPlace(out, vec3(of.position[i]), frame);
        putVector(out, frame.turned(vec3(of.velocity[i])));
        putFloat(out, static_cast<float>(of.density(i)));
        putFloat(out, of.mass[i]);
        if (of.pressure) putFloat(out, (*of.pressure)[i]);
        putWord(out, of.id[i]);
    }
    return out;
}

std::string writeParticlesVtp(const ExportParticles& of, const ExportFrame& frame) {
    const size_t count = of.position.size();
    std::string out = fmt::format(
        "<?xml version=\"1.0\"?>\n<!-- particles at {} s: m, m/s, kg/m^3, kg, Pa; +{} up -->\n"
        "<VTKFile type=\"PolyData\" version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"UInt64\">\n<PolyData>\n",
        of.time, frame.upLetter());
    std::string bytes;
    putDouble(bytes, of.time);
    std::string time;
    addArray(time, "Float64", "TimeValue", 1, bytes);
    time.insert(time.find(" format"), " NumberOfTuples=\"1\"");
    out += "<FieldData>\n" + time + "</FieldData>\n";
    fmt::format_to(std::back_inserter(out),
                   "<Piece NumberOfPoints=\"{}\" NumberOfVerts=\"{}\" NumberOfLines=\"0\" NumberOfStrips=\"0\" NumberOfPolys=\"0\">\n",
                   count, count);
    bytes.clear();
    for (const vec4& p : of.position) putPlace(bytes, vec3(p), frame);
    out += "<Points>\n";
    addArray(out, frame.doubles() ? "Float64" : "Float32", "Points", 3, bytes);
    out += "</Points>\n<PointData Scalars=\"density\" Vectors=\"velocity\">\n";
    bytes.clear();
    for (const vec4& v : of.velocity) putVector(bytes, frame.turned(vec3(v)));
    addArray(out, "Float32", "velocity", 3, bytes);
    bytes.clear();
    for (size_t i = 0; i < count; ++i) putFloat(bytes, static_cast<float>(of.density(i)));
    addArray(out, "Float32", "density", 1, bytes);
    addArray(out, "Float32", "mass", 1, bytesOf(of.mass));
    if (of.pressure) addArray(out, "Float32", "pressure", 1, bytesOf(*of.pressure));
    addArray(out, "UInt32", "id", 1, bytesOf(of.id));
    // Each point is a cell of its own, which ParaView needs to show and to filter it.
    std::string cells, ends;
    for (size_t i = 0; i < count; ++i) {
        putLong(cells, i);
        putLong(ends, i + 1);
    }
    out += "</PointData>\n<Verts>\n";
    addArray(out, "Int64", "connectivity", 1, cells);
    addArray(out, "Int64", "offsets", 1, ends);
    return out + "</Verts>\n</Piece>\n</PolyData>\n</VTKFile>\n";
}

std::string writeParticlesCsv(const ExportParticles& of, const ExportFrame& frame) {
    std::string out = "id,x [m],y [m],z [m],vx [m/s],vy [m/s],vz [m/s],density [kg/m3],mass [kg]";
    out += of.pressure ? ",pressure [Pa]\n" : "\n";
    auto end = std::back_inserter(out);
    for (size_t i = 0; i < of.position.size(); ++i) {
        const vec3 p = frame.turned(vec3(of.position[i])), v = frame.turned(vec3(of.velocity[i]));
        const dvec3 far = frame.place(vec3(of.position[i]));
        if (frame.doubles())
            fmt::format_to(end, "{},{},{},{}", of.id[i], far.x, far.y, far.z);
        else
            fmt::format_to(end, "{},{},{},{}", of.id[i], p.x, p.y, p.z);
        fmt::format_to(end, ",{},{},{},{},{}", v.x, v.y, v.z, static_cast<float>(of.density(i)), of.mass[i]);
        if (of.pressure) fmt::format_to(end, ",{}", (*of.pressure)[i]);
        out += '\n';
    }
    return out;
}

std::string writeVtkCollection(std::span<const TimedFile> files) {
    std::string out = "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"0.1\" byte_order=\"LittleEndian\">\n<Collection>\n";
    for (const TimedFile& f : files)
        fmt::format_to(std::back_inserter(out), "<DataSet timestep=\"{}\" group=\"\" part=\"0\" file=\"{}\"/>\n", f.time, f.file);
    return out + "</Collection>\n</VTKFile>\n";
}

}  // namespace rivulet
