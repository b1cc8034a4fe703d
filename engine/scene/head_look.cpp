#include "engine/scene/head_look.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <glm/matrix.hpp>

#include "engine/scene/load_image.h"

namespace rivulet {
namespace {

constexpr vec3 kTint(0.93F, 1.0F, 1.15F);  // the painted skin is warmer than skin is

// |x|^2 = 2 c . x + (r^2 - |c|^2), least squares about the mean. False where the points lie in a plane.
bool fitSphere(const std::vector<vec3>& points, vec3& centre, float& radius) {
    if (points.size() < 4) return false;
    glm::dvec3 mean(0.0), right(0.0);
    for (const vec3& p : points) mean += glm::dvec3(p) / static_cast<double>(points.size());
    glm::dmat3 spread(0.0);
    double square = 0;
    for (const vec3& p : points) square += glm::dot(glm::dvec3(p) - mean, glm::dvec3(p) - mean) / static_cast<double>(points.size());
    for (const vec3& p : points) {
        const glm::dvec3 x = glm::dvec3(p) - mean;
        spread += glm::outerProduct(x, x);
        right += 0.5 * x * (glm::dot(x, x) - square);
    }
    if (std::abs(glm::determinant(spread)) < 1e-30) return false;
    const glm::dvec3 c = glm::inverse(spread) * right;
    centre = vec3(c + mean);
    radius = static_cast<float>(std::sqrt(square + glm::dot(c, c)));
    return std::isfinite(radius) && radius > 0;
}

Result<std::shared_ptr<const Image>> imageIfThere(const std::string& path) {
    std::error_code error;
    if (!std::filesystem::exists(path, error)) return std::shared_ptr<const Image>();
    Result<Image> image = loadImage(path);
    if (!image) return image.error();
    return std::make_shared<const Image>(std::move(*image));
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

}  // namespace

EyeLook eyeLookOf(const Mesh& mesh) {
    EyeLook look;
    std::vector<vec3> points = mesh.positions;
    if (!fitSphere(points, look.centre, look.radius)) return look;
    for (int again = 0; again < 6; ++again) {  // without what is no part of the ball: the iris's bowl
        std::erase_if(points, [&](const vec3& p) { return std::abs(glm::distance(p, look.centre) - look.radius) > 0.03F * look.radius; });
        if (!fitSphere(points, look.centre, look.radius)) break;
        points = mesh.positions;
    }
    float nearest = 1e9F;
    for (size_t i = 0; i < std::min(mesh.uvs.size(), mesh.positions.size()); ++i) {
        const float d = glm::distance(mesh.uvs[i], vec2(0.5F));
        if (d >= nearest) continue;
        nearest = d;
        look.sight = glm::normalize(mesh.positions[i] - look.centre);
    }
    return look;
}

Status dressHead(Model& head, const std::string& folder) {
    for (ModelPart& part : head.parts) {
        if (part.name == "skin") {
            auto skin = std::make_shared<SkinLook>();
            const std::pair<const char*, std::shared_ptr<const Image>*> pictures[] = {{"head_relief.png", &skin->relief},
                                                                                      {"skin_regions.png", &skin->regions}};
            for (const auto& [name, into] : pictures) {
                Result<std::shared_ptr<const Image>> image = imageIfThere((std::filesystem::path(folder) / name).string());
                if (!image) return image.error();
                *into = std::move(*image);
            }
            part.material.skin = std::move(skin);
            part.material.baseColour = kTint;
        }
        if (part.name.starts_with("caruncle")) {
            auto flesh = std::make_shared<SkinLook>();
            flesh->pores = 0.0F;
            part.material.skin = std::move(flesh);
        }
        if (part.name.starts_with("lashes")) widenStrands(part);
        if (part.name.starts_with("eye") && !part.material.blended) part.material.eye = std::make_shared<EyeLook>(eyeLookOf(part.mesh));
    }
    return ok();
}

}  // namespace rivulet
