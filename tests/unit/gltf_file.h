// A glTF file that a test writes: numbers are in one buffer beside it, the rest is JSON.
#pragma once

#include <fmt/format.h>

#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace rivulet {

class GltfFile {
  public:
    // The accessor's number. `type`: SCALAR, VEC2, VEC3, VEC4, MAT4.
    int floats(std::string_view type, const std::vector<float>& all) {
        return add(5126, type, all, fmt::format(R"(,"min":[{}],"max":[{}])", edges(type, all, false), edges(type, all, true)));
    }
    int shorts(const std::vector<uint16_t>& all) { return add(5123, "SCALAR", all, ""); }
    int bytes(std::string_view type, const std::vector<uint8_t>& all) { return add(5121, type, all, ""); }
    // A closed box's mesh: {"primitives":[...]}, with `more` for its primitive.
    std::string box(float x0, float x1, float y0, float y1, float z0, float z1, const std::string& more = "") {
        std::vector<float> corners;
        for (int k = 0; k < 8; ++k)
            for (const float c : {(k & 1) != 0 ? x1 : x0, (k & 2) != 0 ? y1 : y0, (k & 4) != 0 ? z1 : z0}) corners.push_back(c);
        const int position = floats("VEC3", corners);
        const int index =
            shorts({0, 2, 3, 0, 3, 1, 4, 5, 7, 4, 7, 6, 0, 1, 5, 0, 5, 4, 2, 6, 7, 2, 7, 3, 0, 4, 6, 0, 6, 2, 1, 3, 7, 1, 7, 5});
        return fmt::format(R"({{"primitives":[{{"attributes":{{"POSITION":{}}},"indices":{}{}}}]}})", position, index, more);
    }
    // `rest`: everything but asset, accessors and buffers; of scene 0. Returns its path.
    std::string write(const std::filesystem::path& folder, const std::string& name, const std::string& rest) const {
        std::ofstream(folder / (name + ".bin"), std::ios::binary) << data_;
        const std::string path = (folder / (name + ".gltf")).string();
        std::ofstream(path) << fmt::format(
            R"({{"asset":{{"version":"2.0"}},"scene":0,{},"accessors":[{}],"bufferViews":[{}],"buffers":[{{"uri":"{}.bin","byteLength":{}}}]}})",
            rest, fmt::join(accessors_, ","), fmt::join(views_, ","), name, data_.size());
        return path;
    }

  private:
    static size_t width(std::string_view type) {
        return type == "SCALAR" ? 1 : type == "VEC2" ? 2 : type == "VEC3" ? 3 : type == "VEC4" ? 4 : 16;
    }
    static std::string edges(std::string_view type, const std::vector<float>& all, bool most) {
        std::vector<float> edge(all.begin(), all.begin() + static_cast<std::ptrdiff_t>(width(type)));
        for (size_t k = 0; k < all.size(); ++k) {
            float& e = edge[k % width(type)];
            e = most ? std::max(e, all[k]) : std::min(e, all[k]);
        }
        return fmt::format("{}", fmt::join(edge, ","));
    }
    template <class T>
    int add(int component, std::string_view type, const std::vector<T>& all, const std::string& more) {
        data_.resize((data_.size() + 3) / 4 * 4);
        const size_t bytes = all.size() * sizeof(T);
        views_.push_back(fmt::format(R"({{"buffer":0,"byteOffset":{},"byteLength":{}}})", data_.size(), bytes));
        data_.append(reinterpret_cast<const char*>(all.data()), bytes);
        accessors_.push_back(fmt::format(R"({{"bufferView":{},"componentType":{},"count":{},"type":"{}"{}}})", views_.size() - 1, component,
                                         all.size() / width(type), type, more));
        return static_cast<int>(accessors_.size()) - 1;
    }
    std::string data_;
    std::vector<std::string> accessors_, views_;
};

}  // namespace rivulet
