#include "fluid/scene/head_look.h"

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "engine/scene/import_model.h"
#include "fluid/scene/ball_fit.h"

namespace rivulet {
namespace {

constexpr int kHairs = 5, kBrowHairs = 2;  // on a ribbon
constexpr float kHairWidth = 0.4F;         // of its part of the ribbon
constexpr std::string_view kTearLine = "tearLine";
constexpr vec3 kTint(0.93F, 1.0F, 1.15F);  // the painted skin is warmer than skin is

Result<std::shared_ptr<const Image>> imageIfThere(const std::string& path) {
    std::error_code error;
    if (!std::filesystem::exists(path, error)) return std::shared_ptr<const Image>();
    return importImage(path);
}

// A ribbon narrower than a pixel breaks up into dots: it is made wider, and the hair covers its middle only.
void widenStrands(ModelPart& part) {
    constexpr float kWider = 4.0F;
    std::vector<vec3>& x = part.mesh.positions;
    for (size_t i = 0; i + 1 < std::min(x.size(), part.mesh.uvs.size()); ++i) {
        const vec2 a = part.mesh.uvs[i], b = part.mesh.uvs[i + 1];
        if (a.x != 0.0F || b.x != 1.0F || a.y != b.y) continue;
        const vec3 more = (0.5F * (kWider - 1.0F)) * (x[i + 1] - x[i]);
        x[i] -= more;
        x[i + 1] += more;
    }
    part.material.blended = true;
    part.material.strand = 1.0F / kWider;
}

// Whether all vertices are pairs across ribbons, as make_head writes hair: u from just above a whole number to just below the next.
bool onRibbons(const Mesh& mesh) {
    if (mesh.uvs.empty() || mesh.uvs.size() % 2 != 0) return false;
    for (size_t i = 0; i + 1 < mesh.uvs.size(); i += 2) {
        const vec2 a = mesh.uvs[i], b = mesh.uvs[i + 1];
        if (a.y != b.y || b.x - a.x < 0.9F || std::floor(a.x) != std::floor(b.x)) return false;
    }
    return true;
}

// m, from the eyeball's centre to the white or the cornea.
float eyeSurface(const EyeLook& eye, const vec3& direction) {
    const float forward = glm::dot(direction, eye.sight);
    const float under = eye.corneaRadius * eye.corneaRadius - eye.corneaCentre * eye.corneaCentre * (1.0F - forward * forward);
    if (forward <= 0 || under <= 0) return eye.radius;
    return eye.radius * std::max(1.0F, eye.corneaCentre * forward + std::sqrt(under));
}

// The edge of the lower lid where it touches the eye, from one corner to the other: of the skin's vertices that lie on the eyeball below
// the line of sight, the highest in each of a row of sectors. Indices into the skin's positions.
std::vector<uint32_t> lowerLidEdge(const Mesh& skin, const EyeLook& eye, const vec3& side, const vec3& up) {
    constexpr size_t kSectors = 36;
    constexpr float kNear = 0.16F, kWidest = 0.93F;  // in radii: how far off the ball a lid's edge may be, and how far to the side
    constexpr uint32_t kNone = UINT32_MAX;
    std::vector<uint32_t> highest(kSectors, kNone);
    auto seen = [&](uint32_t v) {
        const vec3 x = (skin.positions[v] - eye.centre) / eye.radius;
        return vec3(glm::dot(x, side), glm::dot(x, up), glm::dot(x, eye.sight));
    };
    for (uint32_t v = 0; v < skin.positions.size(); ++v) {
        const vec3 x = seen(v);
        const float off = glm::length(x) - 1.0F;
        if (x.z < 0.2F || x.y > 0.05F || off < 0.0F || off > kNear || std::abs(x.x) > kWidest) continue;
        const auto sector = std::min(static_cast<size_t>((x.x + kWidest) / (2.0F * kWidest) * kSectors), kSectors - 1);
        // Of a lid's rim the edge that touches the eye is wanted, not the one that lashes grow on: near beats high.
        auto rank = [&](const vec3& p) { return p.y - 0.6F * (glm::length(p) - 1.0F); };
        if (highest[sector] == kNone || rank(x) > rank(seen(highest[sector]))) highest[sector] = v;
    }
    std::erase(highest, kNone);
    return highest;
}

// Of places along a line; its ends stay.
std::vector<vec3> smoothed(std::vector<vec3> line) {
    for (int pass = 0; pass < 8; ++pass) {
        const std::vector<vec3> before = line;
        for (size_t k = 1; k + 1 < line.size(); ++k) line[k] = 0.25F * before[k - 1] + 0.5F * before[k] + 0.25F * before[k + 1];
    }
    return line;
}

}  // namespace

ModelPart makeTearLine(const ModelPart& skin, const EyeLook& eye, const std::string& name, float width) {
    constexpr uint32_t kAcross = 7;
    ModelPart part;
    part.name = name;
    part.node = skin.node;
    part.mesh.name = name;
    const vec3 side = glm::normalize(glm::cross(vec3(0, 1, 0.001F), eye.sight)), up = glm::cross(eye.sight, side);
    const std::vector<uint32_t> edge = lowerLidEdge(skin.mesh, eye, side, up);
    if (edge.size() < 6) return part;
    std::vector<vec3> lid(edge.size());
    for (size_t k = 0; k < edge.size(); ++k) lid[k] = skin.mesh.positions[edge[k]];
    lid = smoothed(lid);
    constexpr float kBrimful = 1.7F;  // of the rest's width
    std::vector<vec3> brimful;
    for (size_t k = 0; k < lid.size(); ++k) {
        const float along = static_cast<float>(k) / static_cast<float>(lid.size() - 1), full = std::sin(kPi * along);
        const vec3 out = glm::normalize(lid[k] - eye.centre), onto = glm::normalize(up - out * glm::dot(up, out));
        const float off = std::max(glm::distance(lid[k], eye.centre) - eyeSurface(eye, out), 1.0e-4F);
        const float reach = width * (0.08F + 0.92F * full);
        // A point of the strip's profile, `up` and `thick` as shares of its reach and of the lid's height over the eye.
        const auto at = [&](float up, float thick) {
            const vec3 above = glm::normalize(lid[k] + onto * (reach * up) - eye.centre);
            return eye.centre + above * (eyeSurface(eye, above) + 2.0e-5F + off * thick);
        };
        for (uint32_t j = 0; j < kAcross; ++j) {  // quarters of ellipses: hollow as a meniscus is, and about to spill
            const float angle = 0.5F * kPi * static_cast<float>(j) / (kAcross - 1);
            part.mesh.positions.push_back(at(1.0F - std::cos(angle), 1.0F - std::sin(angle)));
            part.mesh.uvs.emplace_back(along, static_cast<float>(j) / (kAcross - 1));
            brimful.push_back(at(kBrimful * std::sin(angle), 1.25F * std::cos(angle)) - part.mesh.positions.back());
        }
    }
    const auto stations = static_cast<uint32_t>(lid.size());
    for (uint32_t k = 0; k + 1 < stations; ++k)
        for (uint32_t j = 0; j + 1 < kAcross; ++j) {
            const uint32_t a = k * kAcross + j, b = a + kAcross;
            part.mesh.indices.insert(part.mesh.indices.end(), {a, b, b + 1, a, b + 1, a + 1});
        }
    for (const MorphTarget& morph : skin.morphs) {
        if (morph.name.starts_with("brim")) continue;
        MorphTarget& own = part.morphs.emplace_back();
        own.name = morph.name;
        std::vector<vec3> moved(stations, vec3(0.0F));
        for (uint32_t k = 0; k < stations; ++k) {
            const auto at = std::lower_bound(morph.vertices.begin(), morph.vertices.end(), edge[k]);
            if (at != morph.vertices.end() && *at == edge[k]) moved[k] = morph.offsets[static_cast<size_t>(at - morph.vertices.begin())];
        }
        moved = smoothed(moved);  // else the film is dented where the lid's vertices are uneven
        for (uint32_t k = 0; k < stations; ++k) {
            if (moved[k] == vec3(0.0F)) continue;
            for (uint32_t j = 0; j < kAcross; ++j) {
                own.vertices.push_back(k * kAcross + j);
                own.offsets.push_back(moved[k]);
            }
        }
    }
    if (name.starts_with(kTearLine)) {
        MorphTarget& own = part.morphs.emplace_back();
        own.name = "brim" + name.substr(kTearLine.size());
        for (uint32_t v = 0; v < brimful.size(); ++v) own.vertices.push_back(v);
        own.offsets = brimful;
    }
    part.mesh.normals.assign(part.mesh.positions.size(), eye.sight);
    part.material.baseColour = vec3(1.0F);
    part.material.opacity = 0.02F;
    part.material.roughness = 0.04F;
    part.material.blended = true;
    return part;
}

EyeLook eyeLookOf(const Mesh& mesh) {
    EyeLook look;
    if (!fitBall(mesh.positions, look.centre, look.radius)) return look;
    float nearest = 1e9F;
    for (size_t i = 0; i < std::min(mesh.uvs.size(), mesh.positions.size()); ++i) {
        const float d = glm::distance(mesh.uvs[i], vec2(0.5F));
        if (d >= nearest) continue;
        nearest = d;
        look.sight = glm::normalize(mesh.positions[i] - look.centre);
    }
    return look;
}

void wetFoundEyes(Model& head, size_t skin, const FoundFace& face) {
    constexpr float kWet = 0.08F, kUpright = 0.7F;
    const bool known = std::any_of(head.parts.begin(), head.parts.end(), [](const ModelPart& p) { return p.material.eye != nullptr; });
    if (known || face.by != FoundFace::By::balls || face.up.y < kUpright) return;
    for (ModelPart& part : head.parts)
        if (std::find(face.balls.begin(), face.balls.end(), nameOf(part)) != face.balls.end() && head.parts[skin].name != part.name)
            part.material.roughness = std::min(part.material.roughness, kWet);
    for (size_t side = 0; side < 2; ++side) {
        EyeLook eye{face.eyes[side].centre, face.forward, face.eyes[side].radius};
        eye.corneaRadius = 0;  // its bulge is not known
        ModelPart line = makeTearLine(head.parts[skin], eye, std::string(kTearLine) + (side == 0 ? "Left" : "Right"));
        if (!line.mesh.indices.empty()) head.parts.push_back(std::move(line));
    }
}

Status dressHead(Model& head, const std::string& folder) {
    std::vector<ModelPart> lines;
    for (ModelPart& part : head.parts) {
        if (part.name == "skin") {
            auto skin = std::make_shared<SkinLook>();
            const std::pair<const char*, std::shared_ptr<const Image>*> pictures[] = {
                {"head_relief.png", &skin->relief}, {"skin_regions.png", &skin->regions}, {"head_flush.jpg", &skin->flushes}};
            for (const auto& [name, into] : pictures) {
                Result<std::shared_ptr<const Image>> image = imageIfThere((std::filesystem::path(folder) / name).string());
                if (!image) return image.error();
                *into = std::move(*image);
            }
            part.material.skin = std::move(skin);
            part.material.baseColour = kTint;
            part.material.doubleSided = true;  // beside the eye one looks into the head
        }
        if (part.name.starts_with("caruncle")) {
            auto flesh = std::make_shared<SkinLook>();
            flesh->pores = 0.0F;
            part.material.skin = std::move(flesh);
            part.material.doubleSided = true;
        }
        if (part.name.starts_with("lashes")) widenStrands(part);
        if ((part.name == "teeth" || part.name == "tongue") && !part.material.occlusion) {  // little light from around reaches into a mouth
            auto shade = std::make_shared<Image>();
            shade->width = shade->height = 1;
            shade->rgba = {70, 70, 70, 255};
            part.material.occlusion = shade;
        }
        if ((part.name == "hair" || part.name == "brows") && onRibbons(part.mesh)) {
            part.material.blended = true;
            part.material.strand = kHairWidth;
            part.material.strands = part.name == "brows" ? kBrowHairs : kHairs;
        }
        if (part.name.starts_with("eye") && !part.material.blended) part.material.eye = std::make_shared<EyeLook>(eyeLookOf(part.mesh));
    }
    if (const ModelPart* skin = head.find("skin"); skin != nullptr)
        for (const ModelPart& part : head.parts) {
            if (!part.material.eye) continue;
            ModelPart line = makeTearLine(*skin, *part.material.eye, std::string(kTearLine) + part.name.substr(3));
            if (!line.mesh.indices.empty()) lines.push_back(std::move(line));
        }
    for (ModelPart& line : lines) head.parts.push_back(std::move(line));
    return ok();
}

}  // namespace rivulet
