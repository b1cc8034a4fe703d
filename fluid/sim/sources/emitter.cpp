#include "fluid/sim/sources/emitter.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "engine/core/param_fixed.h"
#include "fluid/sim/sources/liquids.h"

namespace rivulet {

namespace {

// A nozzle that was blocked emits its backlog faster by this factor.
constexpr double kCatchUp = 1.1;
constexpr double kLoose = 1.01;  // of a jet's lattice

double latticeEdge(float spacing) { return kLoose * std::pow(2.0, 1.0 / 6) * double{spacing}; }
double layerGap(float spacing) { return std::sqrt(2.0 / 3) * latticeEdge(spacing); }

double openingArea(const EmitterParams& p) { return kPiD * double{p.radius} * double{p.radius}; }
double nozzleSpeed(const EmitterParams& p) { return p.speed > 0 ? double{p.speed} : 1.0e-3 * double{p.litresPerSecond} / openingArea(p); }

// Scrambles bits: a number in [0, 1) for every k and axis (the finaliser of MurmurHash3, Appleby 2011).
float random01(uint64_t k, uint32_t axis) {
    uint64_t x = k * 4 + axis + 1;
    for (const uint64_t factor : {0xff51afd7ed558ccdULL, 0xc4ceb9fe1a85ec53ULL}) {
        x ^= x >> 33U;
        x *= factor;
    }
    return static_cast<float>((x ^ (x >> 33U)) >> 40U) * 0x1p-24F;
}

// Two directions across `n`, a unit vector.
std::pair<vec3, vec3> across(const vec3& n) {
    const vec3 other = std::abs(n.y) < 0.9F ? vec3(0, 1, 0) : vec3(1, 0, 0);
    const vec3 u = glm::normalize(glm::cross(other, n));
    return {u, glm::cross(n, u)};
}

}  // namespace

void EmitterParams::visit(ParamVisitor& v) {
    static const std::vector<std::string> shapes = {"nozzle", "box", "mesh"};
    v.choice({.name = "shape", .doc = "nozzle: a round opening; box: a volume that fills; mesh: the surface of a mesh", .fixed = kFixed},
             shape, shapes);
    v.value({"litresPerSecond", "l/s", "flow rate", 0, 1.0e6, kLog}, litresPerSecond);
    v.value({"speed", "m/s", "speed of the new fluid; 0 for a nozzle = the speed that the rate needs through its opening", 0, 1000}, speed);
    v.value({"position", "m", "centre of the opening or box, or position of the mesh's origin (with fitSize: of its centre)", -kMaxPosition,
             kMaxPosition},
            position);
    v.value({"direction", "", "direction of the fluid from a nozzle or box, of any length", -1.0e6, 1.0e6}, direction);
    v.value({"radius", "m", "radius of a nozzle's opening; the jet is thinner if the rate needs less", 1.0e-4, 100, kLog}, radius);
    v.value({"size", "m", "edge lengths of a box", 0, kMaxPosition}, size);
    v.value({.name = "mesh", .doc = "mesh file, searched as a collider's", .fixed = kFixed}, mesh);
    v.value({"fitSize", "m", "length that the mesh's longest side is scaled to; 0 = not scaled", 0, kMaxPosition, kLog, kFixed}, fitSize);
    v.value({"rotation", "deg", "rotation of the mesh about x, then y, then z", -360, 360, kLinear, kFixed}, rotation);
    v.value({"start", "s", "time at which the emitter starts", 0, 3600}, start);
    v.value({"stop", "s", "time at which the emitter stops; 0 = never", 0, 3600}, stop);
    visitLiquid(v, "liquid of the emitter; empty = that of fluid.liquid", liquid);
    visitDye(v, dye, dyeAmount, dyeScattering);
    v.list({.name = "attributes", .doc = "values of fluid.attributes that the particles of the emitter have"}, attributes);
}

void SinkParams::visit(ParamVisitor& v) {
    static const std::vector<std::string> shapes = {"box", "sphere"};
    v.choice({.name = "shape", .doc = "shape of the volume in which particles are removed"}, shape, shapes);
    v.value({"position", "m", "centre of the volume", -kMaxPosition, kMaxPosition}, position);
    v.value({"size", "m", "edge lengths of a box", 0, kMaxPosition}, size);
    v.value({"radius", "m", "radius of a sphere", 0, kMaxPosition}, radius);
}

double volumeAfter(const EmitterParams& p, double seconds) {
    const double end = p.stop > 0 ? std::min(seconds, double{p.stop}) : seconds;
    return 1.0e-3 * double{p.litresPerSecond} * std::max(end - double{p.start}, 0.0);
}

std::string contradiction(const EmitterParams& p) {
    if (p.shape != "mesh" && !(glm::length(p.direction) > 1.0e-6F)) return "direction must have a length";
    const double most = 1.0e3 * openingArea(p) * nozzleSpeed(p);
    if (p.shape == "nozzle" && p.speed > 0 && double{p.litresPerSecond} > 1.05 * most)
        return fmt::format(
            "litresPerSecond is {}, but at a speed of {} m/s an opening of radius {} m lets out {:.3g} l/s: use a larger radius or a "
            "higher speed",
            p.litresPerSecond, p.speed, p.radius, most);
    if (p.stop > 0 && p.stop < p.start) return fmt::format("stop is {} s, before start, {} s", p.stop, p.start);
    return "";
}

double layerOf(const EmitterParams& p, float spacing) {
    if (p.shape != "nozzle" || !(p.litresPerSecond > 0)) return 0;
    const double sideways = 1.0e-3 * double{p.litresPerSecond} / nozzleSpeed(p);  // m^2, of the jet
    return std::max(std::round(sideways * layerGap(spacing) / std::pow(double{spacing}, 3)), 1.0);
}

EmitterFeed::EmitterFeed(const Emitter& emitter, uint32_t index, float spacing) : emitter_(emitter), index_(index), spacing_(spacing) {
    double sum = 0;
    for (size_t t = 0; t + 2 < emitter_.triangles.size(); t += 3) {
        const vec3 &a = emitter_.triangles[t], &b = emitter_.triangles[t + 1], &c = emitter_.triangles[t + 2];
        sum += 0.5 * static_cast<double>(glm::length(glm::cross(b - a, c - a)));
        areas_.push_back(sum);
    }
    take(prepare(emitter_.params));
}

EmitterFeed::Next EmitterFeed::prepare(const EmitterParams& params) const {
    Next next{params, params.speed, {}};
    keepFixed(next.params, emitter_.params);
    layOut(next);
    return next;
}

void EmitterFeed::take(Next next) noexcept {
    emitter_.params = std::move(next.params);
    speed_ = next.speed;
    layers_ = std::move(next.layers);
}

float EmitterFeed::fastest() const {
    return !deposits_ && emitter_.params.shape == "nozzle" ? static_cast<float>(kCatchUp) * speed_ : speed_;
}

void EmitterFeed::reset() { restore({}, {}); }

void EmitterFeed::restore(const Account& account, const Flight& flight) {
    account_ = account;
    flight_ = flight;
    if (deposits_) speed_ = glm::length(flight_.velocity);
}

EmitterFeed EmitterFeed::ofDeposits(uint32_t index, float spacing) {
    EmitterFeed feed(index, spacing);
    feed.deposits_ = true;
    return feed;
}

void EmitterFeed::deposit(const vec3& place, const vec3& velocity, double volume) {
    const double share = volume / std::pow(double{spacing_}, 3);
    account_.due += share;
    flight_.places[flight_.next] = place;
    flight_.next = (flight_.next + 1) % flight_.places.size();
    flight_.count = std::min(flight_.count + 1, static_cast<uint32_t>(flight_.places.size()));
    // The mean over about as much as a particle holds.
    flight_.velocity += (velocity - flight_.velocity) * static_cast<float>(std::min(share, 1.0));
    speed_ = glm::length(flight_.velocity);
}

// A particle at each place at most, above the water that it came down on: where that is full, at another height the next time.
void EmitterFeed::offerDeposits(const vec3& gravity, size_t most, std::vector<Candidate>& to) {
    const double want = std::floor(account_.due + 1.0e-6) - static_cast<double>(account_.offered - account_.refused);
    const uint64_t places = flight_.count;
    if (!(want >= 1) || places == 0) return;
    const vec3 against = glm::length(gravity) > 0 ? -gravity : -flight_.velocity;
    const vec3 up = glm::length(against) > 0 ? glm::normalize(against) : vec3(0, 1, 0);
    const auto count = static_cast<uint64_t>(std::min({want, static_cast<double>(places), static_cast<double>(most)}));
    for (uint64_t k = account_.offered; k < account_.offered + count; ++k) {
        const vec3 at = flight_.places[k % places] + up * (spacing_ * (0.75F + 0.75F * static_cast<float>((k + k / places) % 4)));
        to.push_back({vec4(at, static_cast<float>(index_)), vec4(flight_.velocity, 0.0F), matter, absorption});
    }
    account_.offered += count;
}

// The closest packing of spheres as layers across the jet, stretched by a hair: the smoothing kernel finds that lattice 1.3 % denser than
// the cubic one it is calibrated on, and a jet that is spawned compressed bursts. So many a layer that at the jet's speed layers follow
// each other as the packing wants.
void EmitterFeed::layOut(Next& to) const {
    const EmitterParams& p = to.params;
    if (p.shape != "nozzle" || !(p.litresPerSecond > 0)) return;
    const double s = spacing_, a = latticeEdge(spacing_), v = nozzleSpeed(p);
    to.speed = static_cast<float>(v);
    const double sideways = 1.0e-3 * double{p.litresPerSecond} / v;  // m^2, of the jet
    const auto n = static_cast<size_t>(layerOf(p, spacing_));
    const auto [u, w] = across(glm::normalize(p.direction));
    const int reach = static_cast<int>(std::ceil(std::sqrt(sideways / kPiD) / (0.8 * a))) + 2;
    for (int layer = 0; layer < 2; ++layer) {
        struct Place {
            double x, y;
            int64_t order;  // by distance, ties by angle
        };
        std::vector<Place> places;
        for (int j = -reach; j <= reach; ++j)
            for (int i = -reach; i <= reach; ++i) {
                const double x = (i + 0.5 * (j & 1) + 0.5 * layer - 0.25) * a,
                             y = (j * std::sqrt(0.75) + layer / std::sqrt(12.0) - 1 / std::sqrt(48.0)) * a;
                places.push_back({x, y, std::llround((x * x + y * y) / (s * s) * 1.0e6)});
            }
        std::stable_sort(places.begin(), places.end(), [](const Place& l, const Place& r) { return l.order < r.order; });
        for (size_t k = 0; k < std::min(n, places.size()); ++k)
            to.layers[static_cast<size_t>(layer)].push_back(u * static_cast<float>(places[k].x) + w * static_cast<float>(places[k].y));
    }
}

// A place of a cubic lattice in the box. The lattice is moved, round and round, whenever it has been gone through, and gone through in no
// order that the eye finds.
vec3 EmitterFeed::onBox(uint64_t k) const {
    const EmitterParams& p = emitter_.params;
    uint64_t n[3], sites = 1;
    for (int axis = 0; axis < 3; ++axis) {
        n[axis] = static_cast<uint64_t>(std::max(std::floor(p.size[axis] / spacing_ + 1.0e-3F), 1.0F));
        sites *= n[axis];
    }
    uint64_t stride = std::max<uint64_t>(static_cast<uint64_t>(0.6180339887 * static_cast<double>(sites)), 1);
    while (std::gcd(stride, sites) != 1) ++stride;
    const uint64_t turn = k / sites;
    uint64_t site = (k % sites * stride + turn) % sites;
    vec3 at;
    for (int axis = 0; axis < 3; ++axis) {
        const auto count = static_cast<float>(n[axis]);
        const float cell =
            n[axis] == 1 ? 0.5F : std::fmod(static_cast<float>(site % n[axis]) + random01(turn, static_cast<uint32_t>(axis)), count);
        site /= n[axis];
        at[axis] = p.position[axis] + (cell / count - 0.5F) * (n[axis] == 1 ? 0.0F : std::max(p.size[axis], count * spacing_));
    }
    return at;
}

void EmitterFeed::onMesh(uint64_t k, vec3& at, vec3& normal) const {
    const double pick = static_cast<double>(random01(k, 0)) * areas_.back();
    const auto t = static_cast<size_t>(std::upper_bound(areas_.begin(), areas_.end() - 1, pick) - areas_.begin()) * 3;
    const vec3 &a = emitter_.triangles[t], &b = emitter_.triangles[t + 1], &c = emitter_.triangles[t + 2];
    const float root = std::sqrt(random01(k, 1)), share = random01(k, 2);
    at = a * (1.0F - root) + b * (root * (1.0F - share)) + c * (root * share);
    const vec3 n = glm::cross(b - a, c - a);
    normal = glm::length(n) > 0 ? glm::normalize(n) : vec3(0, 1, 0);
    at += normal * spacing_;  // off the surface, which may be solid
}

void EmitterFeed::offer(double time, double seconds, const vec3& gravity, size_t most, std::vector<Candidate>& to) {
    if (deposits_) return offerDeposits(gravity, most, to);
    const EmitterParams& p = emitter_.params;
    const double perSecond = 1.0e-3 * double{p.litresPerSecond} / std::pow(double{spacing_}, 3);
    const double regular = (volumeAfter(p, time + seconds) - volumeAfter(p, time)) / std::pow(double{spacing_}, 3);
    account_.due += regular;
    const double whole = std::floor(account_.due + 1.0e-6);
    const double want = whole - static_cast<double>(account_.offered - account_.refused);
    if (!(want >= 1) || !(perSecond > 0)) return;
    const bool nozzle = p.shape == "nozzle", mesh = p.shape == "mesh";
    if (mesh && areas_.empty()) return;
    double limit = std::min(want, static_cast<double>(most));
    if (nozzle) limit = std::min(limit, std::ceil(kCatchUp * perSecond * seconds) + 1);
    if (mesh) limit = std::min(limit, 4 * std::ceil(perSecond * seconds) + 16);
    if (p.shape == "box") {
        double sites = 1;
        for (int axis = 0; axis < 3; ++axis) sites *= std::max(std::floor(double{p.size[axis]} / double{spacing_} + 1.0e-3), 1.0);
        limit = std::min(limit, sites);  // each place once
    }
    const auto count = static_cast<uint64_t>(limit);
    const vec3 way = glm::length(p.direction) > 0 ? glm::normalize(p.direction) : vec3(0.0F);
    // How far the counting of layers is, at the end of this time.
    const double head = static_cast<double>(account_.offered + count) + (limit == want ? std::max(account_.due - whole, 0.0) : 0.0);
    const double hurry = nozzle && want > regular + 2 ? kCatchUp : 1.0;
    const double pace = hurry * perSecond;
    const float speed = speed_ * static_cast<float>(hurry);
    for (uint64_t k = account_.offered; k < account_.offered + count; ++k) {
        vec3 at, velocity;
        if (nozzle) {
            const uint64_t n = layers_[0].size(), layer = k / n;
            // A layer is a plane that left the opening when its first particle was due.
            const auto age = static_cast<float>(std::max(head - static_cast<double>(layer * n), 0.0) / pace);
            velocity = way * speed + gravity * age;
            at = p.position + layers_[layer % 2][k % n] + way * (speed * age) + gravity * (0.5F * age * age);
        } else if (mesh) {
            vec3 normal;
            onMesh(k, at, normal);
            velocity = normal * speed_;
        } else {
            at = onBox(k);
            velocity = way * speed_;
        }
        to.push_back({vec4(at, static_cast<float>(index_)), vec4(velocity, 0.0F), matter, absorption});
    }
    account_.offered += count;
}

}  // namespace rivulet
