#include "engine/scene/skin.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <map>
#include <tuple>

#include "engine/scene/transform.h"
#include "shaders/material/deform.h"

namespace rivulet {
namespace {

Status checkPart(const ModelPart& part) {
    const size_t n = part.mesh.positions.size();
    auto wrong = [&](std::string_view what) { return badInput(fmt::format("the part '{}' {}", part.name, what)); };
    for (const uint32_t index : part.mesh.indices)
        if (index >= n) return wrong("has a triangle whose index is out of range");
    for (const MorphTarget& morph : part.morphs) {
        if (morph.vertices.size() != morph.offsets.size())
            return wrong(fmt::format("has a morph '{}' without an offset for each of its vertices", morph.name));
        for (const uint32_t v : morph.vertices)
            if (v >= n) return wrong(fmt::format("has a morph '{}' whose vertices are out of range", morph.name));
    }
    if (!part.grips.empty() && part.grips.size() != n) return wrong("has bones, but not a grip for each vertex");
    for (const Grip& grip : part.grips)
        for (int k = 0; k < 4; ++k)
            if (grip.bone[k] >= part.bones.size()) return wrong("has a vertex held by a bone that is not there");
    return ok();
}

// Vertices at the same position share their triangles, so that seams have one normal.
struct Rings {
    std::vector<uint32_t> ring, corner;
};
Rings ringsOf(const Mesh& mesh) {
    const size_t n = mesh.positions.size();
    std::map<std::tuple<float, float, float>, uint32_t> places;
    std::vector<uint32_t> placeOf(n);
    for (size_t i = 0; i < n; ++i) {
        const vec3 p = mesh.positions[i] + 0.0F;  // turns -0 into 0
        placeOf[i] = places.emplace(std::tuple(p.x, p.y, p.z), static_cast<uint32_t>(places.size())).first->second;
    }
    std::vector<uint32_t> begin(places.size() + 1, 0);
    for (const uint32_t v : mesh.indices) ++begin[placeOf[v] + 1];
    for (size_t k = 0; k + 1 < begin.size(); ++k) begin[k + 1] += begin[k];
    Rings out;
    out.corner.resize(2 * mesh.indices.size());
    std::vector<uint32_t> next = begin;
    for (size_t t = 0; t + 2 < mesh.indices.size(); t += 3)
        for (size_t k = 0; k < 3; ++k) {
            const size_t at = next[placeOf[mesh.indices[t + k]]]++;
            out.corner[2 * at] = mesh.indices[t + (k + 1) % 3];
            out.corner[2 * at + 1] = mesh.indices[t + (k + 2) % 3];
        }
    for (size_t i = 0; i < n; ++i) {
        out.ring.push_back(begin[placeOf[i]]);
        out.ring.push_back(begin[placeOf[i] + 1]);
    }
    return out;
}

template <class T>
Status put(Device& device, Buffer& into, const std::vector<T>& items, size_t atLeast = 1) {
    Result<Buffer> made = device.allocate(std::max(items.size(), atLeast) * sizeof(T));
    if (!made) return made.error();
    into = std::move(*made);
    if (!items.empty()) device.write(into, std::as_bytes(std::span(items)));
    return ok();
}

bool finite(const mat4& m) {
    for (int c = 0; c < 4; ++c)
        if (!isFinite(vec3(m[c]))) return false;
    return true;
}

}  // namespace

Status Deformer::fillTables(const ModelPart& part) {
    std::vector<vec4> rest, offset, grip;
    for (const vec3& p : part.mesh.positions) rest.emplace_back(p, 0.0F);
    std::vector<uint32_t> begin(part.mesh.positions.size() + 1, 0);
    for (const MorphTarget& morph : part.morphs)
        for (const uint32_t v : morph.vertices) ++begin[v + 1];
    for (size_t k = 0; k + 1 < begin.size(); ++k) begin[k + 1] += begin[k];
    offset.resize(begin.back());
    std::vector<uint32_t> next = begin;
    for (size_t m = 0; m < part.morphs.size(); ++m) {
        float furthest = 0;
        for (size_t k = 0; k < part.morphs[m].vertices.size(); ++k) {
            offset[next[part.morphs[m].vertices[k]]++] = vec4(part.morphs[m].offsets[k], static_cast<float>(m));
            furthest = std::max(furthest, glm::length(part.morphs[m].offsets[k]));
        }
        reach_.push_back(furthest);
    }
    for (const Grip& g : part.grips) {
        grip.emplace_back(vec4(g.bone));
        grip.push_back(g.weight);
    }
    const Rings rings = ringsOf(part.mesh);
    const std::vector<vec4> none;
    const Status all[] = {put(*device_, rest_, rest),
                          put(*device_, begin_, begin),
                          put(*device_, offset_, offset),
                          put(*device_, amount_, std::vector<float>(part.morphs.size(), 0.0F)),
                          put(*device_, grip_, grip),
                          put(*device_, bone_, none, 3 * part.bones.size() + 1),
                          put(*device_, point_, none, rest.size()),
                          put(*device_, ring_, rings.ring),
                          put(*device_, corner_, rings.corner),
                          put(*device_, normal_, none, rest.size())};
    for (const Status& s : all)
        if (!s) return s.error();
    return ok();
}

Result<Deformer> Deformer::create(Device& device, const ModelPart& part) {
    if (Status right = checkPart(part); !right) return right.error();
    Deformer d;
    d.device_ = &device;
    d.vertices_ = static_cast<uint32_t>(part.mesh.positions.size());
    d.boneCount_ = part.grips.empty() ? 0 : part.bones.size();
    d.restBounds_ = part.mesh.bounds();
    for (auto [kernel, path] : {std::pair(&d.deform_, "material/deform"), std::pair(&d.gatherNormals_, "material/normals")}) {
        Result<Kernel> found = device.kernel(path);
        if (!found) return found.error();
        *kernel = *found;
    }
    if (Status filled = d.fillTables(part); !filled) return filled.error();
    d.run({});
    return d;
}

void Deformer::run(std::span<const float> weights, std::span<const mat4> bones) {
    std::vector<float> amount(reach_.size(), 0.0F);
    float reach = 0;
    for (size_t k = 0; k < std::min(amount.size(), weights.size()); ++k) {
        amount[k] = std::isfinite(weights[k]) ? weights[k] : 0.0F;
        reach += std::abs(amount[k]) * reach_[k];
    }
    std::vector<mat4> turned(bones.empty() ? 0 : boneCount_, mat4(1.0F));
    for (size_t k = 0; k < std::min(turned.size(), bones.size()); ++k)
        if (finite(bones[k])) turned[k] = bones[k];
    if (version_ > 0 && amount == weights_ && turned == turned_) return;
    bounds_ = restBounds_;
    if (!bounds_.empty()) {
        bounds_.min -= reach;
        bounds_.max += reach;
    }
    std::vector<vec4> rows;
    Bounds around;
    for (const mat4& m : turned) {
        for (int r = 0; r < 3; ++r) rows.emplace_back(m[0][r], m[1][r], m[2][r], m[3][r]);
        const Bounds b = transformBounds(m, bounds_);
        if (!b.empty()) around.add(b.min), around.add(b.max);
    }
    if (!turned.empty()) bounds_ = around;  // a vertex is a weighted mean of the positions that its bones give it
    if (!amount.empty()) device_->write(amount_, std::as_bytes(std::span(amount)));
    if (!rows.empty()) device_->write(bone_, std::as_bytes(std::span(rows)));
    const DeformParams params{vertices_, static_cast<uint32_t>(turned.size()), 0, 0};
    device_->run(deform_, params, {&rest_, &begin_, &offset_, &amount_, &grip_, &bone_, &point_}, vertices_);
    device_->run(gatherNormals_, params, {&point_, &ring_, &corner_, &normal_}, vertices_);
    weights_ = std::move(amount);
    turned_ = std::move(turned);
    ++version_;
}

size_t Deformer::bytes() const {
    size_t sum = 0;
    for (const Buffer* b : {&rest_, &begin_, &offset_, &amount_, &grip_, &bone_, &point_, &ring_, &corner_, &normal_}) sum += b->bytes();
    return sum;
}

std::shared_ptr<const DeformedVertices> readLater(const std::shared_ptr<const Deformer>& deformer) {
    auto all = std::make_shared<DeformedVertices>();
    all->bounds = deformer->bounds();
    all->version = deformer->version();
    all->of = deformer;
    const auto read = [&](const Buffer& from, std::vector<vec4> DeformedVertices::*to) {
        deformer->device().readLater(from, deformer->vertices() * sizeof(vec4), [all, to](std::span<const std::byte> bytes) {
            std::vector<vec4>& vertices = (*all).*to;
            vertices.resize(bytes.size() / sizeof(vec4));
            std::memcpy(vertices.data(), bytes.data(), bytes.size());
        });
    };
    read(deformer->positions(), &DeformedVertices::positions);
    read(deformer->normals(), &DeformedVertices::normals);
    return all;
}

}  // namespace rivulet
