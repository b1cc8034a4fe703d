#include "assets/make_head/glb.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>

#include "assets/make_head/morphs.h"

namespace rivulet::head {
namespace {

class Writer {
  public:
    int view(const void* bytes, size_t size, int target) {
        while (binary_.size() % 4 != 0) binary_.push_back('\0');
        views_ += fmt::format("{}{{\"buffer\":0,\"byteOffset\":{},\"byteLength\":{}{}}}", views_.empty() ? "" : ",", binary_.size(), size,
                              target ? fmt::format(",\"target\":{}", target) : "");
        binary_.append(static_cast<const char*>(bytes), size);
        return viewCount_++;
    }
    int accessor(const std::string& fields) {
        accessors_ += fmt::format("{}{{{}}}", accessors_.empty() ? "" : ",", fields);
        return accessorCount_++;
    }
    int vectors(const std::vector<dvec3>& values, double scale, bool bounds) {
        std::vector<float> data = flat(values, scale);
        int at = view(data.data(), data.size() * 4, 34962);
        return accessor(fmt::format(R"("bufferView":{},"componentType":5126,"count":{},"type":"VEC3"{})", at, values.size(),
                                    bounds ? boundsOf(data) : ""));
    }
    int uvs(const std::vector<dvec2>& values) {
        std::vector<float> data;
        for (dvec2 uv : values) {
            data.push_back(static_cast<float>(std::round(uv.x * 1e6) / 1e6));
            data.push_back(static_cast<float>(std::round((1 - uv.y) * 1e6) / 1e6));
        }
        int at = view(data.data(), data.size() * 4, 34962);
        return accessor(fmt::format(R"("bufferView":{},"componentType":5126,"count":{},"type":"VEC2")", at, values.size()));
    }
    int indices(const std::vector<Triangle>& triangles, size_t vertices) {
        int at = 0;
        if (vertices <= 65535) {
            std::vector<uint16_t> data;
            for (const Triangle& t : triangles)
                for (uint32_t v : t) data.push_back(static_cast<uint16_t>(v));
            at = view(data.data(), data.size() * 2, 34963);
        } else {
            at = view(triangles.data(), triangles.size() * sizeof(Triangle), 34963);
        }
        return accessor(fmt::format(R"("bufferView":{},"componentType":{},"count":{},"type":"SCALAR")", at, vertices <= 65535 ? 5123 : 5125,
                                    triangles.size() * 3));
    }
    int displacements(const std::vector<dvec3>& values) {
        std::vector<uint16_t> where;
        std::vector<dvec3> what;
        for (size_t v = 0; v < values.size(); ++v)
            if (values[v] != dvec3(0)) {
                where.push_back(static_cast<uint16_t>(v));
                what.push_back(values[v]);
            }
        if (where.empty()) {  // a sparse accessor must hold something
            where.push_back(0);
            what.emplace_back(0);
        }
        std::vector<float> data = flat(what, 0.01);
        int whereView = view(where.data(), where.size() * 2, 0), whatView = view(data.data(), data.size() * 4, 0);
        data.insert(data.end(), 3, 0.0F);  // the bounds are those of every vertex, moved or not
        return accessor(fmt::format(R"("componentType":5126,"count":{},"type":"VEC3"{},"sparse":{{"count":{},"indices":{{"bufferView":{},)"
                                    R"("componentType":5123}},"values":{{"bufferView":{}}}}})",
                                    values.size(), boundsOf(data), where.size(), whereView, whatView));
    }
    std::string file(const std::string& rest) {
        while (binary_.size() % 4 != 0) binary_.push_back('\0');
        std::string json = fmt::format(R"({{"asset":{{"version":"2.0","generator":"make_head"}},{},"accessors":[{}],"bufferViews":[{}],)"
                                       R"("buffers":[{{"byteLength":{}}}]}})",
                                       rest, accessors_, views_, binary_.size());
        while (json.size() % 4 != 0) json.push_back(' ');
        std::string bytes = "glTF";
        auto number = [&](size_t n) {
            auto value = static_cast<uint32_t>(n);
            bytes.append(reinterpret_cast<const char*>(&value), 4);
        };
        number(2);
        number(12 + 8 + json.size() + 8 + binary_.size());
        number(json.size());
        bytes += "JSON" + json;
        number(binary_.size());
        bytes += std::string("BIN\0", 4) + binary_;
        return bytes;
    }

  private:
    static std::vector<float> flat(const std::vector<dvec3>& values, double scale) {
        std::vector<float> data;
        data.reserve(values.size() * 3);
        for (dvec3 v : values)
            for (int k = 0; k < 3; ++k) data.push_back(static_cast<float>(std::round(v[k] * scale * 1e6) / 1e6 + 0.0));  // + 0.0: no -0
        return data;
    }
    static std::string boundsOf(const std::vector<float>& data) {
        float low[3] = {1e9F, 1e9F, 1e9F}, high[3] = {-1e9F, -1e9F, -1e9F};
        for (size_t i = 0; i < data.size(); ++i) {
            low[i % 3] = std::min(low[i % 3], data[i]);
            high[i % 3] = std::max(high[i % 3], data[i]);
        }
        return fmt::format(R"(,"min":[{},{},{}],"max":[{},{},{}])", low[0], low[1], low[2], high[0], high[1], high[2]);
    }
    std::string binary_, views_, accessors_;
    int viewCount_ = 0, accessorCount_ = 0;
};

struct MaterialText {
    const char *name, *text;
};
// Base colours are linear.
const MaterialText kMaterials[] = {
    {"skin", R"("pbrMetallicRoughness":{"baseColorTexture":{"index":0},"metallicFactor":0,"roughnessFactor":0.5})"},
    {"eye", R"("pbrMetallicRoughness":{"baseColorTexture":{"index":1},"metallicFactor":0,"roughnessFactor":0.2})"},
    {"cornea", R"("alphaMode":"BLEND","pbrMetallicRoughness":{"baseColorFactor":[1,1,1,0.06],"metallicFactor":0,"roughnessFactor":0.03})"},
    {"caruncle", R"("pbrMetallicRoughness":{"baseColorTexture":{"index":1},"metallicFactor":0,"roughnessFactor":0.2})"},
    {"teeth", R"("pbrMetallicRoughness":{"baseColorFactor":[0.66,0.60,0.50,1],"metallicFactor":0,"roughnessFactor":0.28})"},
    {"tongue", R"("pbrMetallicRoughness":{"baseColorFactor":[0.42,0.15,0.13,1],"metallicFactor":0,"roughnessFactor":0.42})"},
    {"drop", R"("alphaMode":"BLEND","pbrMetallicRoughness":{"baseColorFactor":[1,1,1,0.10],"metallicFactor":0,"roughnessFactor":0.03})"},
    {"hair",
     R"("doubleSided":true,"pbrMetallicRoughness":{"baseColorFactor":[0.060,0.036,0.022,1],"metallicFactor":0,"roughnessFactor":0.4})"},
    {"lashes",
     R"("doubleSided":true,"pbrMetallicRoughness":{"baseColorFactor":[0.015,0.010,0.008,1],"metallicFactor":0,"roughnessFactor":0.6})"},
};

}  // namespace

dvec3 rounded(dvec3 p) { return glm::round(p * 1e4) / 1e4; }

std::string asGlb(const std::vector<Part>& parts) {
    Writer writer;
    std::string meshes, nodes, roots, materials;
    for (const MaterialText& m : kMaterials)
        materials += fmt::format("{}{{\"name\":\"{}\",{}}}", materials.empty() ? "" : ",", m.name, m.text);
    for (size_t i = 0; i < parts.size(); ++i) {
        const Part& part = parts[i];
        int material = 0;
        while (part.material != kMaterials[material].name) ++material;
        std::string targets, names, weights;
        for (size_t m = 0; m < part.morphs.size(); ++m) {
            const auto& morph = part.morphs[m];
            if (std::all_of(morph.begin(), morph.end(), [](const dvec3& d) { return d == dvec3(0); })) continue;
            targets += fmt::format("{}{{\"POSITION\":{}}}", targets.empty() ? "" : ",", writer.displacements(morph));
            names += fmt::format("{}\"{}\"", names.empty() ? "" : ",", kMorphNames[m]);
            weights += weights.empty() ? "0" : ",0";
        }
        int positions = writer.vectors(part.positions, 0.01, true), normals = writer.vectors(part.normals, 1, false);
        int uvs = writer.uvs(part.uvs), indices = writer.indices(part.triangles, part.positions.size());
        meshes += fmt::format(R"({}{{"name":"{}","primitives":[{{"attributes":{{"POSITION":{},"NORMAL":{},"TEXCOORD_0":{}}},"indices":{},)"
                              R"("material":{}{}}}]{}}})",
                              i == 0 ? "" : ",", part.name, positions, normals, uvs, indices, material,
                              targets.empty() ? "" : fmt::format(R"(,"targets":[{}])", targets),
                              targets.empty() ? "" : fmt::format(R"(,"weights":[{}],"extras":{{"targetNames":[{}]}})", weights, names));
        nodes += fmt::format(R"({}{{"name":"{}","mesh":{}}})", i == 0 ? "" : ",", part.name, i);
        roots += fmt::format("{}{}", i == 0 ? "" : ",", i);
    }
    return writer.file(fmt::format(R"("scene":0,"scenes":[{{"nodes":[{}]}}],"nodes":[{}],"meshes":[{}],"materials":[{}],)"
                                   R"("textures":[{{"source":0,"sampler":0}},{{"source":1,"sampler":0}}],)"
                                   R"("samplers":[{{"magFilter":9729,"minFilter":9987,"wrapS":33071,"wrapT":33071}}],)"
                                   R"("images":[{{"uri":"head_albedo.jpg"}},{{"uri":"eye_albedo.jpg"}}])",
                                   roots, nodes, meshes, materials));
}

}  // namespace rivulet::head
