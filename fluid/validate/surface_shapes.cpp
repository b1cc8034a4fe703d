#include "fluid/validate/surface_shapes.h"

#include <cmath>

#include "fluid/render/raymarch.h"
#include "fluid/session/scene_renderer.h"

namespace rivulet {

namespace {

constexpr float kSplatSpacing = 0.01F;  // m
constexpr float kBall = 0.2F;           // m, radius
constexpr float kPool = 0.3F;           // m, half its side
constexpr float kPoolDepth = 0.1F;      // m, of the pool

// Pseudo-random numbers in -1 .. 1, the same on every machine.
class Jitter {
  public:
    explicit Jitter(double spacings) : size_(spacings) {}
    vec3 operator()() { return {next(), next(), next()}; }

  private:
    float next() {
        state_ = state_ * 6364136223846793005ULL + 1442695040888963407ULL;
        return static_cast<float>(size_ * (static_cast<double>(state_ >> 40U) / 8388608.0 - 1));
    }
    double size_;
    uint64_t state_ = 1;
};

// A cubic lattice, jittered by `jitter` spacings, within `in` (m).
template <class In>
SplatSet lattice(double jitter, const In& in) {
    Jitter off(jitter);
    SplatSet p{{}, kSplatSpacing, {}};
    const int reach = static_cast<int>(std::ceil(kPool / kSplatSpacing)) + 1;
    for (int z = -reach; z < reach; ++z)
        for (int y = -reach; y < reach; ++y)
            for (int x = -reach; x < reach; ++x) {
                const vec3 at = kSplatSpacing * (vec3(x, y, z) + 0.5F);
                if (in(at)) p.at.emplace_back(at + kSplatSpacing * off(), 1.0F);
            }
    return p;
}

// A drop as surface tension arranges it: shells one spacing apart, evenly covered (Swinbank & Purser 2006), then jittered.
SplatSet settledBall(double jitter) {
    Jitter off(jitter);
    SplatSet p{{}, kSplatSpacing, {}};
    for (float r = kBall - 0.5F * kSplatSpacing; r > 0; r -= kSplatSpacing) {
        const int count = std::max(static_cast<int>(std::lround(4 * kPi * r * r / (kSplatSpacing * kSplatSpacing))), 1);
        for (int k = 0; k < count; ++k) {
            const float y = (2.0F * static_cast<float>(k) + 1) / static_cast<float>(count) - 1, flat = std::sqrt(1 - y * y);
            const float turn = 2.39996323F * static_cast<float>(k) + 100 * r;
            p.at.emplace_back(r * vec3(flat * std::cos(turn), y, flat * std::sin(turn)) + kSplatSpacing * off(), 1.0F);
        }
    }
    return p;
}

SplatSet pool(double jitter) {
    SplatSet p =
        lattice(jitter, [](const vec3& x) { return std::abs(x.x) < kPool && std::abs(x.z) < kPool && x.y < 0 && x.y > -kPoolDepth; });
    p.box.add({-kPool, -kPoolDepth, -kPool});
    p.box.add({kPool, kPoolDepth, kPool});
    return p;
}

FrameView viewOf(const vec3& from, const vec3& target, int width, int height) {
    Camera camera;
    camera.position = from;
    camera.target = target;
    camera.fieldOfView = 34;
    camera.nearPlane = 0.05F;
    camera.farPlane = 10;
    return frameViewOf(camera, LightParams{}, width, height, 0);
}

// A surface from `depth` (along a world ray from the camera whose view depth is 1) and `normal` (world space).
template <class Depth, class Normal>
SurfaceMap analytic(const FrameView& view, const Depth& depth, const Normal& normal) {
    SurfaceMap map{view.width, view.height, {}, {}};
    const dmat4 projection(view.projection);
    const dmat3 turn = glm::transpose(dmat3(view.view));
    const dvec3 eye(view.cameraPosWorld);
    for (int y = 0; y < view.height; ++y)
        for (int x = 0; x < view.width; ++x) {
            const double u = 2 * (x + 0.5) / view.width - 1, v = 2 * (y + 0.5) / view.height - 1;
            const dvec3 way = turn * dvec3(u / projection[0][0], v / projection[1][1], -1);
            const double t = depth(eye, way);
            map.depth.push_back(static_cast<float>(t));
            map.normal.emplace_back(glm::transpose(turn) * normal(eye + t * way));
        }
    return map;
}

SurfaceMap sphereMap(const FrameView& view, double radius) {
    return analytic(
        view,
        [=](const dvec3& eye, const dvec3& way) {
            const double a = glm::dot(way, way), b = glm::dot(eye, way), root = b * b - a * (glm::dot(eye, eye) - radius * radius);
            return root < 0 ? double{kNoDepth} : (-b - std::sqrt(root)) / a;
        },
        [](const dvec3& p) { return glm::normalize(p); });
}

// The level of the pool, away from its walls.
SurfaceMap levelMap(const FrameView& view) {
    return analytic(
        view,
        [](const dvec3& eye, const dvec3& way) {
            const double t = way.y < 0 ? -eye.y / way.y : double{kNoDepth};
            const dvec3 p = eye + t * way;
            const double room = double{kPool} - 6 * double{kSplatSpacing};
            return std::abs(p.x) < room && std::abs(p.z) < room ? t : double{kNoDepth};
        },
        [](const dvec3&) { return dvec3(0, 1, 0); });
}

}  // namespace

std::vector<SurfaceShape> surfaceShapes(int width, int height) {
    const FrameView ball = viewOf({0.25F, 0.35F, 0.8F}, vec3(0.0F), width, height),
                    level = viewOf({0.1F, 0.42F, 0.85F}, vec3(0.0F), width, height);
    const SurfaceMap sphere = sphereMap(ball, double{kBall}), plane = levelMap(level);
    const auto inBall = [](const vec3& p) { return glm::length(p) < kBall; };
    return {{"sphere", settledBall(0.1), ball, sphere, true, true},
            {"sphere cut from a lattice", lattice(0, inBall), ball, sphere, true, false},
            {"sphere cut from a jittered lattice", lattice(0.25, inBall), ball, sphere, true, false},
            {"slab", pool(0.1), level, plane, false, true},
            {"slab, jittered by a quarter", pool(0.25), level, plane, false, false}};
}

}  // namespace rivulet
