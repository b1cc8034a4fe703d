#include "tests/fuzz/fuzz_case.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <set>
#include <sstream>

#include "engine/core/json.h"
#include "fluid/sim/methods/method.h"
#include "fluid/sim/sources/block.h"

namespace rivulet::fuzz {

namespace {

constexpr double kMostParticles = 2000;
constexpr int kFrames = 60, kFew = 4;
// Default number of steps per frame: the program's own limit, so that stiff settings slow simulated time and not the test.
constexpr int kSubsteps = 12;

VisitFn visiting(SceneFile& scene) {
    return [&scene](ParamVisitor& v) { scene.visit(v); };
}

// A column that falls beside a drop, a nozzle, a sink, a slope in a corner.
SceneFile tank() {
    SceneFile s;
    s.fluid.maxSubsteps = kSubsteps;
    s.duration = 1;
    s.fluid.box = {.min = vec3(0), .max = vec3(0.4F, 0.4F, 0.24F)};
    s.fluid.blocks = {
        {.min = vec3(0), .max = vec3(0.2F, 0.2F, 0.24F)},
        {.min = vec3(0.26F, 0.2F, 0.08F), .max = vec3(0.34F, 0.3F, 0.16F), .velocity = vec3(0, -1, 0), .dye = vec3(1, 0.2F, 0.1F)}};
    s.colliders.resize(1);
    s.colliders[0].shape = "plane";
    s.colliders[0].position = vec3(0.36F, 0, 0);
    s.colliders[0].normal = vec3(-1, 1, 0);
    s.emitters.resize(1);
    s.emitters[0].position = vec3(0.1F, 0.35F, 0.12F);
    s.emitters[0].radius = 0.03F;
    s.emitters[0].litresPerSecond = 2;
    s.sinks.resize(1);
    s.sinks[0].position = vec3(0.38F, 0.1F, 0.22F);
    s.sinks[0].size = vec3(0.04F);
    return s;
}

// The same with every force on: a Param that does nothing where another is 0 does something here.
SceneFile forces() {
    SceneFile s = tank();
    s.fluid.viscosity = 1.0e-3F;
    s.fluid.collision.friction = 0.2F;
    s.fluid.collision.walls = "no-slip";
    ForcesParams& f = s.fluid.forces;
    f.tension = 0.05F;
    f.adhesion = 0.05F;
    f.thesisTension = -1;
    f.normals = "gradient";
    f.vorticity = 0.5F;
    f.airDrag = 0.5F;
    f.wind = vec3(1, 0, 0);
    return s;
}

// A static mesh, a rotating and shaking one, and a deforming one.
SceneFile solids() {
    SceneFile s;
    s.fluid.maxSubsteps = kSubsteps;
    s.duration = 1;
    s.fluid.box = {.min = vec3(0), .max = vec3(0.4F, 0.4F, 0.24F)};
    s.fluid.blocks = {{.min = vec3(0, 0.1F, 0), .max = vec3(0.4F, 0.26F, 0.24F)}};
    s.colliders.resize(3);
    ColliderParams& still = s.colliders[0];
    still.mesh = "meshes/beach.obj";
    still.fitSize = 0.2F;
    still.position = vec3(0.1F, 0.04F, 0.12F);
    still.resolution = 24;
    ColliderParams& turning = s.colliders[1];
    turning.mesh = "meshes/paddle.obj";
    turning.fitSize = 0.16F;
    turning.position = vec3(0.26F, 0.3F, 0.12F);
    turning.resolution = 24;
    turning.motion.spin = 90;
    turning.motion.shake = vec3(0.02F, 0, 0);
    turning.motion.keys.resize(2);
    turning.motion.keys[1].time = 1;
    turning.motion.keys[1].rotation = vec3(0, 45, 0);
    ColliderParams& bending = s.colliders[2];
    bending.mesh = "meshes/paddle.obj";
    bending.fitSize = 0.16F;
    bending.position = vec3(0.32F, 0.1F, 0.12F);
    bending.resolution = 24;
    bending.wave.amplitude = 0.02F;
    bending.wave.length = 0.2F;
    return s;
}

// Floating bodies, and a wall of boundary particles.
SceneFile bodies() {
    SceneFile s;
    s.fluid.maxSubsteps = kSubsteps;
    s.duration = 1;
    s.fluid.box = {.min = vec3(0), .max = vec3(0.4F, 0.4F, 0.24F)};
    s.fluid.blocks = {{.min = vec3(0), .max = vec3(0.4F, 0.12F, 0.24F)}};
    s.bodies.resize(2);
    s.bodies[0].position = vec3(0.14F, 0.16F, 0.12F);
    s.bodies[0].size = vec3(0.1F, 0.06F, 0.1F);
    s.bodies[1].shape = "sphere";
    s.bodies[1].radius = 0.04F;
    s.bodies[1].position = vec3(0.3F, 0.14F, 0.12F);
    s.bodies[1].density = 2000;
    s.bodies[1].parts.resize(0);
    return s;
}

// A pool with a ball in which water sleeps some frames after it has become calm: each drag wakes it, and it falls asleep again.
SceneFile calm() {
    SceneFile s;
    s.fluid.maxSubsteps = kSubsteps;
    s.duration = 1;
    s.fluid.sleep = {.on = true, .speed = 1, .after = 0.5F};
    s.fluid.soundSpeed = 8;  // so that kSubsteps steps are a frame
    s.fluid.box = {.min = vec3(0), .max = vec3(0.4F, 0.4F, 0.24F)};
    s.fluid.blocks = {{.min = vec3(0), .max = vec3(0.4F, 0.12F, 0.24F)}};
    s.bodies.resize(1);
    s.bodies[0].shape = "sphere";
    s.bodies[0].radius = 0.04F;
    s.bodies[0].position = vec3(0.1F, 0.2F, 0.12F);
    return s;
}

// The thesis's method refuses bodies in every scene, and sleeping water.
bool fits(const std::string& base, const std::string& method) { return (base != "bodies" && base != "calm") || method != "wcsph_thesis"; }

Status set(Case& c, const std::string& assignment) {
    const VisitFn visit = visiting(c.scene);
    if (Status done = setParam(assignment, visit); !done) return done;
    c.set.push_back(assignment);
    return ok();
}

// Assigns all of it; a spacing first, and the scene with it, as large in spacings as before.
Status setAll(Case& c, const std::vector<std::string>& assignments) {
    const std::string spacing = "fluid.spacing=";
    for (const std::string& a : assignments) {
        if (!a.starts_with(spacing)) continue;
        const float before = c.scene.fluid.spacing;
        if (Status done = set(c, a); !done) return done;
        scaleLengths(c.scene, c.scene.fluid.spacing / before);
    }
    for (const std::string& a : assignments)
        if (!a.starts_with(spacing))
            if (Status done = set(c, a); !done) return done;
    return ok();
}

// A scene that holds more than 2,000 particles gets its blocks cut down about their low corners; what emitters would bring waits where
// fluid.maxParticles, the program's own limit, is reached.
void keepSmall(SceneFile& scene) {
    const auto count = [&scene] {
        double sum = 0;
        for (const BlockParams& b : scene.fluid.blocks) sum += blockCount(b, scene.fluid.spacing);
        return sum;
    };
    for (int k = 0; k < 200 && count() > kMostParticles; ++k)
        for (BlockParams& b : scene.fluid.blocks) {
            const auto shrink = static_cast<float>(std::clamp(std::cbrt(kMostParticles / count()), 0.01, 0.98));
            b.max = b.min + (b.max - b.min) * shrink;
        }
    constexpr int kSlots = static_cast<int>(1.5 * kMostParticles);
    const bool open = !scene.emitters.empty() && scene.fluid.maxParticles == 0;
    if (open || scene.fluid.maxParticles > kSlots) scene.fluid.maxParticles = kSlots;
}

// There, back, and there again.
void dragged(Case& c, SceneFile base, std::span<const std::pair<std::string, std::string>> values) {
    for (const Slider& s : slidersOf(base))
        for (const auto& [path, value] : values)
            if (s.path == path && !s.fixed) {
                c.drags.push_back({c.frames / 3, path, s.text});
                c.drags.push_back({2 * c.frames / 3, path, value});
            }
}

std::pair<std::string, std::string> parted(const std::string& assignment) {
    const size_t equals = assignment.find('=');
    if (equals == std::string::npos) return {assignment, ""};
    return {assignment.substr(0, equals), assignment.substr(equals + 1)};
}

const Slider* find(const std::vector<Slider>& sliders, const std::string& path) {
    const auto at = std::find_if(sliders.begin(), sliders.end(), [&](const Slider& s) { return s.path == path; });
    return at == sliders.end() ? nullptr : &*at;
}

Status sweep(Case& c, const std::vector<Slider>& sliders, const std::string& path) {
    const Slider* s = find(sliders, path);
    if (s == nullptr) return badInput(path + " is no Param of this base");
    const std::vector<std::string> values = s->values();
    const int each = c.scene.fluid.sleep.on ? 6 : 2;  // until it sleeps again
    for (size_t k = 0; k < values.size(); ++k) c.drags.push_back({each * static_cast<int>(k + 1), path, values[k]});
    c.drags.push_back({each * static_cast<int>(values.size() + 1), path, s->text});
    c.frames = each * static_cast<int>(values.size() + 2);
    return setAll(c, {path + "=" + values.back()});
}

Status corners(Case& c, const std::vector<Slider>& sliders, const std::string& a, const std::string& b) {
    const Slider *first = find(sliders, a), *second = find(sliders, b);
    if (first == nullptr || second == nullptr) return badInput(fmt::format("{} or {} is no Param of this base", a, b));
    const size_t pick = hashOf(c.name) % 2;
    const std::vector<std::string> x = first->ends(), y = second->ends();
    // Which end in which stretch: round the corners, so that one is dragged at a time.
    constexpr int kEach = 3;
    const auto end = [&](const Slider& s, bool isFirst, size_t k) -> size_t {
        return s.fixed ? (pick + (isFirst ? 0U : 1U)) % 2 : isFirst ? (k + 1) / 2 % 2 : k / 2 % 2;
    };
    for (size_t k = 1; k < 4; ++k) {
        if (end(*first, true, k) != end(*first, true, k - 1)) c.drags.push_back({kEach * static_cast<int>(k), a, x[end(*first, true, k)]});
        if (end(*second, false, k) != end(*second, false, k - 1))
            c.drags.push_back({kEach * static_cast<int>(k), b, y[end(*second, false, k)]});
    }
    c.frames = kEach * 4;
    return setAll(c, {a + "=" + x[end(*first, true, 0)], b + "=" + y[end(*second, false, 0)]});
}

Status combination(Case& c, const std::string& method, const std::string& number) {
    uint64_t seed = 0;
    const auto [end, wrong] = std::from_chars(number.data(), number.data() + number.size(), seed);
    if (wrong != std::errc{} || end != number.data() + number.size()) return badInput(number + " is no seed: give a whole number");
    Random random(seed * 0x9e3779b97f4a7c15ULL + hashOf(method));
    // Most often the scene that shows most.
    const std::array<const char*, 7> often = {"tank",
                                              "forces",
                                              "forces",
                                              "tank",
                                              "solids",
                                              fits("bodies", method) ? "bodies" : "solids",
                                              fits("calm", method) ? "calm" : "solids"};
    Result<SceneFile> base = baseScene(often[below(random, often.size())], method);
    if (!base) return base.error();
    c.scene = std::move(*base);
    const std::vector<Slider> sliders = slidersOf(c.scene);
    const double size = double{c.scene.fluid.box.max.x};
    std::vector<std::string> assignments;
    for (size_t left = 2 + below(random, 15); left > 0; --left) {
        const Slider& s = sliders[below(random, sliders.size())];
        if (s.path != "fluid.method") assignments.push_back(s.path + "=" + s.draw(random, size));
    }
    // The spacing first: the scene goes with it.
    std::stable_partition(assignments.begin(), assignments.end(), [](const std::string& a) { return a.starts_with("fluid.spacing="); });
    for (size_t left = below(random, 7); left > 0; --left) {
        const Slider& s = sliders[below(random, sliders.size())];
        if (s.fixed) continue;
        const int frame = 1 + static_cast<int>(below(random, static_cast<size_t>(c.frames) - 1));
        c.drags.push_back({frame, s.path, s.draw(random, size)});
        if (oneIn(random, 2)) c.drags.push_back({frame + 1 + static_cast<int>(below(random, 10)), s.path, s.text});
    }
    std::stable_sort(c.drags.begin(), c.drags.end(), [](const Drag& a, const Drag& b) { return a.frame < b.frame; });
    c.frameSeed = random() | 1U;
    // One after the other, as at a panel: values in conflict with others are refused, and the scene stays.
    for (const std::string& a : assignments) {
        const Case before = c;
        if (Status done = setAll(c, {a}); !done) return done;
        if (Status sense = checkScene(c.scene); sense) continue;
        c.scene = before.scene;
        c.set.back() += "  (refused)";
    }
    return ok();
}

// Paths below fluid and in the lists; rendering and interface parameters have no effect on a step.
bool isSimulated(const Slider& s) { return s.path.starts_with("fluid.") || s.path.find('[') != std::string::npos; }

// One of the methods.
std::string chosen(const std::string& key, const std::string& base) {
    std::vector<std::string> names = methods().names();
    std::erase_if(names, [&](const std::string& method) { return !fits(base, method); });
    return names[hashOf(key) % names.size()];
}

}  // namespace

std::span<const BaseRow> bases() {
    static constexpr BaseRow rows[] = {{"tank", tank}, {"forces", forces}, {"solids", solids}, {"bodies", bodies}, {"calm", calm}};
    return rows;
}

Result<SceneFile> baseScene(const std::string& base, const std::string& method) {
    for (const BaseRow& row : bases()) {
        if (base != row.name) continue;
        SceneFile scene = row.make();
        scene.name = "fuzz";
        const VisitFn visit = visiting(scene);
        if (Status done = setParam("fluid.method=" + method, visit); !done) return done.error();
        return scene;
    }
    return badInput(base + " is no base scene of the fuzzer");
}

Result<Case> caseOf(const std::string& name) {
    std::istringstream words(name);
    std::vector<std::string> w;
    for (std::string word; words >> word;) w.push_back(word);
    Case c;
    c.name = name;
    c.frames = kFrames;
    if (w.size() < 3) return badInput("'" + name + "' is no case of the fuzzer: see fuzz_case.h for their names");
    if (w[1] == "random") {
        if (Status made = combination(c, w[0], w[2]); !made) return made.error();
        keepSmall(c.scene);
        return c;
    }
    Result<SceneFile> base = baseScene(w[2], w[0]);
    if (!base) return base.error();
    c.scene = *base;
    const std::vector<Slider> sliders = slidersOf(c.scene);
    Status made = badInput("'" + name + "' is no case of the fuzzer: see fuzz_case.h for their names");
    if (w[1] == "start" && w.size() == 4) {
        made = setAll(c, {w[3]});
        c.frames = kFew;
    } else if (w[1] == "single" && w.size() == 4) {
        made = setAll(c, {w[3]});
        dragged(c, *base, std::array{parted(w[3])});
    } else if (w[1] == "pair" && w.size() == 5) {
        made = setAll(c, {w[3], w[4]});
        dragged(c, *base, std::array{parted(w[3]), parted(w[4])});
    } else if (w[1] == "sweep" && w.size() == 4) {
        made = sweep(c, sliders, w[3]);
    } else if (w[1] == "corners" && w.size() == 5) {
        made = corners(c, sliders, w[3], w[4]);
    }
    if (!made) return made.error();
    keepSmall(c.scene);
    return c;
}

std::vector<std::string> singles(const std::string& method, bool sample) {
    std::vector<std::string> names;
    std::set<std::string> done = {"fluid.method"};  // every test has each
    for (const BaseRow& row : bases()) {
        Result<SceneFile> base = baseScene(row.name, method);
        if (!base || !fits(row.name, method) || std::string_view(row.name) == "calm") continue;
        for (const Slider& s : slidersOf(*base)) {
            // An item of a list is another thing in each base.
            const std::string key = s.path.find('[') == std::string::npos ? s.path : fmt::format("{} {}", row.name, s.path);
            if (!done.insert(key).second) continue;
            // What starts a world, and what is no Param of the fluid, is the same for all methods: a sample tries it with one of them.
            if (sample && (s.fixed || !s.path.starts_with("fluid.")) && method != chosen(key, row.name)) continue;
            if (sample && !s.fixed) {
                names.push_back(fmt::format("{} sweep {} {}", method, row.name, s.path));
                continue;
            }
            for (const std::string& value : s.values())
                names.push_back(fmt::format("{} {} {} {}={}", method, sample ? "start" : "single", row.name, s.path, value));
        }
    }
    return names;
}

std::vector<std::string> pairs(const std::string& method, bool sample) {
    std::vector<std::string> names;
    std::set<std::string> done;
    for (const char* name : {"forces", "solids", "bodies"}) {
        Result<SceneFile> base = baseScene(name, method);
        if (!base || !fits(name, method)) continue;
        std::vector<Slider> sliders = slidersOf(*base);
        std::erase_if(sliders, [](const Slider& s) { return !isSimulated(s) || s.path == "fluid.method"; });
        for (size_t a = 0; a < sliders.size(); ++a)
            for (size_t b = a + 1; b < sliders.size(); ++b) {
                const std::string& x = sliders[a].path;
                const std::string& y = sliders[b].path;
                if (!done.insert(fmt::format("{} {}", x, y)).second) continue;
                if (sample) {
                    names.push_back(fmt::format("{} corners {} {} {}", method, name, x, y));
                    continue;
                }
                for (const std::string& u : sliders[a].ends())
                    for (const std::string& v : sliders[b].ends())
                        names.push_back(fmt::format("{} pair {} {}={} {}={}", method, name, x, u, y, v));
            }
    }
    return names;
}

std::vector<std::string> sleeping(const std::string& method, bool sample) {
    std::vector<std::string> names;
    Result<SceneFile> base = baseScene("calm", method);
    if (!base || !fits("calm", method)) return names;
    for (const Slider& s : slidersOf(*base)) {
        if (!isSimulated(s) || s.path == "fluid.method") continue;
        if (sample && s.fixed) continue;
        if (sample) {
            names.push_back(fmt::format("{} sweep calm {}", method, s.path));
            continue;
        }
        for (const std::string& value : s.values()) names.push_back(fmt::format("{} single calm {}={}", method, s.path, value));
    }
    return names;
}

std::string sceneText(SceneFile scene) {
    SceneFile plain;
    const VisitFn defaults = visiting(plain);
    return writeJson(visiting(scene), &defaults);
}

}  // namespace rivulet::fuzz
