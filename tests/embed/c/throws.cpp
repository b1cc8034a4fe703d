// A C++ host whose callbacks throw, and whose memory runs out: the call returns the exception's text, and the world goes on.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <new>
#include <stdexcept>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "check.h"

namespace {

bool throws = false;
int logged = 0;

void advance(void*, const rivulet_body_load*, const float*, double, rivulet_body_state* states, size_t) {
    if (throws) throw std::runtime_error("the engine is out of fuel");
    states[0].pose.position[1] += 1e-3F;
}
void reset(void*, const rivulet_body_state*, size_t) {
    if (throws) throw 7;
}
void log(void*, rivulet_level, const char*) {
    ++logged;
    throw std::runtime_error("the log is full");
}

void added(void* user, uint32_t id, const rivulet_body_state*) {
    if (throws) throw std::runtime_error("the engine is full");
    static_cast<std::vector<uint32_t>*>(user)->push_back(id);
}
void removed(void* user, uint32_t id) {
    std::vector<uint32_t>& ids = *static_cast<std::vector<uint32_t>*>(user);
    for (size_t k = 0; k < ids.size(); ++k)
        if (ids[k] == id) return static_cast<void>(ids.erase(ids.begin() + static_cast<std::ptrdiff_t>(k)));
}
void stays(void*, const rivulet_body_load*, const float*, double, rivulet_body_state*, size_t) {}

long allocationsLeft = -1;  // until one fails; negative: none does
void* allocated(size_t bytes) {
    if (allocationsLeft >= 0 && allocationsLeft-- == 0) throw std::bad_alloc();
    if (void* memory = std::malloc(bytes > 0 ? bytes : 1)) return memory;
    throw std::bad_alloc();
}

rivulet_world* worldOf(rivulet_context* context, std::vector<uint32_t>& engine, int samples) {
    rivulet_body_host host{};
    host.size = sizeof host;
    host.user = &engine;
    host.advance = stays;
    host.reset = reset;
    host.added = added;
    host.removed = removed;
    const std::string json = R"({"fluid": {"spacing": 0.05, "box": {"max": [0.5, 0.8, 0.5]}, "blocks": [{"max": [0.5, 0.25, 0.5]}],
        "sleep": {"on": true}, "bodies": {"maxSamples": )" +
                             std::to_string(samples) + "}}}";
    rivulet_world_options scene{};
    scene.size = sizeof scene;
    scene.json = json.c_str();
    scene.body_host = &host;
    rivulet_world* world = nullptr;
    DONE(rivulet_world_create(context, &scene, &world, &why));
    return world;
}

// What the world and the engine know of bodies agrees, and a step moves them all.
void checkBodies(rivulet_world* world, const std::vector<uint32_t>& engine, size_t expected) {
    size_t count = 99;
    std::vector<uint32_t> ids(8);
    std::vector<rivulet_body_state> states(8);
    DONE(rivulet_world_body_ids(world, ids.data(), ids.size(), &count, &why));
    CHECK(count == expected && engine.size() == expected);
    for (size_t k = 0; k < std::min(count, engine.size()); ++k) CHECK(ids[k] == engine[k]);
    DONE(rivulet_world_bodies(world, states.data(), count, &why));
    DONE(rivulet_world_step(world, nullptr, 1.0 / 240, &why));
}

rivulet_body sampled(const float* samples) {
    rivulet_body body{};
    body.size = sizeof body;
    body.samples = samples;
    body.samples_count = 2;
    body.mass = 0.1F;
    body.volume = 1e-4F;
    for (float& inertia : body.inertia) inertia = 1e-4F;
    for (float& x : body.pose.position) x = 0.3F;
    return body;
}

constexpr float kSamples[6] = {0.02F, 0, 0, -0.02F, 0, 0};

// Whichever allocation of a call fails, a body is in the world with all that belongs to it, or it is not.
void memoryRunsOut(rivulet_context* context) {
    std::vector<uint32_t> engine;
    engine.reserve(8);
    rivulet_world* world = worldOf(context, engine, 100);
    const rivulet_body body = sampled(kSamples);
    DONE(rivulet_world_step(world, nullptr, 1.0 / 60, &why));
    bool failed = true;
    int refusals = 0;
    for (long n = 0; failed && n < 1000; ++n) {
        uint32_t id = 0;
        allocationsLeft = n;
        const rivulet_status status = rivulet_world_add_body(world, &body, &id, &why);
        failed = allocationsLeft < 0;
        allocationsLeft = -1;
        refusals += status != RIVULET_OK ? 1 : 0;
        checkBodies(world, engine, status == RIVULET_OK ? 1 : 0);
        if (status == RIVULET_OK) DONE(rivulet_world_remove_body(world, id, &why));
    }
    failed = true;
    for (long n = 0; failed && n < 1000; ++n) {
        uint32_t id = 0;
        DONE(rivulet_world_add_body(world, &body, &id, &why));
        allocationsLeft = n;
        const rivulet_status status = rivulet_world_remove_body(world, id, &why);
        failed = allocationsLeft < 0;
        allocationsLeft = -1;
        refusals += status != RIVULET_OK ? 1 : 0;
        checkBodies(world, engine, status == RIVULET_OK ? 0 : 1);
        if (status != RIVULET_OK) DONE(rivulet_world_remove_body(world, id, &why));
    }
    CHECK(!failed && refusals > 4);
    rivulet_world_destroy(world);
}

const float kCorners[12] = {0, 0, 0, 0.2F, 0, 0, 0, 0.2F, 0, 0, 0, 0.2F};
const uint32_t kFaces[12] = {0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3};
rivulet_body meshed(const rivulet_mesh& mesh) {
    rivulet_body body{};
    body.size = sizeof body;
    body.mesh = &mesh;
    body.density = 500;
    for (float& x : body.pose.position) x = 0.1F;
    return body;
}
// Steps without time until the body is ready. What they return.
rivulet_status arrived(rivulet_world* world, uint32_t id, int32_t& inside) {
    inside = 0;
    for (int k = 0; k < 5000 && inside == 0; ++k) {
        if (rivulet_world_step(world, nullptr, 0, &why) != RIVULET_OK) return RIVULET_FAILED;
        if (rivulet_world_body(world, id, &inside, nullptr, nullptr, &why) != RIVULET_OK) return RIVULET_OK;
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    return RIVULET_OK;
}

// An engine that refuses a body which is ready: the frame is stepped, and the body keeps the reason.
void theEngineRefuses(rivulet_context* context) {
    std::vector<uint32_t> engine;
    rivulet_world* world = worldOf(context, engine, 500);
    rivulet_mesh mesh{};
    mesh.size = sizeof mesh;
    mesh.positions = kCorners;
    mesh.vertices = 4;
    mesh.indices = kFaces;
    mesh.indices_count = 12;
    const rivulet_body body = meshed(mesh);
    uint32_t id = 0;
    int32_t inside = 0;
    DONE(rivulet_world_add_body(world, &body, &id, &why));
    throws = true;
    CHECK(arrived(world, id, inside) == RIVULET_OK && inside == 0);
    throws = false;
    CHECK(rivulet_world_body(world, id, &inside, nullptr, nullptr, &why) == RIVULET_FAILED);
    CHECK(strcmp(why.message, "body 0: body_host.added threw an exception: the engine is full") == 0);
    checkBodies(world, engine, 0);
    rivulet_stats stats{};
    stats.size = sizeof stats;
    DONE(rivulet_world_stats(world, &stats, &why));
    CHECK(stats.time > 0);
    DONE(rivulet_world_remove_body(world, id, &why));
    rivulet_world_destroy(world);
}

// While a stop is asked nothing enters, leaves or is removed; afterwards it does.
void nothingChangesInAStop(rivulet_context* context) {
    std::vector<uint32_t> engine;
    rivulet_world* world = worldOf(context, engine, 500);
    rivulet_mesh mesh{};
    mesh.size = sizeof mesh;
    mesh.positions = kCorners;
    mesh.vertices = 4;
    mesh.indices = kFaces;
    mesh.indices_count = 12;
    const rivulet_body body = meshed(mesh), other = sampled(kSamples);
    uint32_t id = 0;
    int32_t inside = 0;
    rivulet_particles all{};
    all.size = sizeof all;
    DONE(rivulet_world_particles(world, &all, &why));
    const size_t before = all.count;
    DONE(rivulet_world_add_body(world, &body, &id, &why));
    rivulet_context_stop(context, 1);
    for (int k = 0; k < 300; ++k) {  // it is ready long before
        (void)rivulet_world_step(world, nullptr, 0, &why);
        std::this_thread::sleep_for(std::chrono::milliseconds(2));
    }
    DONE(rivulet_world_body(world, id, &inside, nullptr, nullptr, &why));
    CHECK(inside == 0);
    uint32_t second = 0;
    CHECK(rivulet_world_add_body(world, &other, &second, &why) == RIVULET_FAILED && strstr(why.message, "a stop is asked") != nullptr);
    rivulet_context_stop(context, 0);
    CHECK(arrived(world, id, inside) == RIVULET_OK && inside == 1);
    DONE(rivulet_world_particles(world, &all, &why));
    CHECK(all.count < before);
    rivulet_context_stop(context, 1);
    CHECK(rivulet_world_remove_body(world, id, &why) == RIVULET_FAILED && strstr(why.message, "a stop is asked") != nullptr);
    rivulet_context_stop(context, 0);
    checkBodies(world, engine, 1);
    rivulet_world_destroy(world);
}

// The functions by which a GPU moves bodies: `fails` is the one that does.
enum class Fails { none, contacts, adding, passed, predict };
Fails fails = Fails::none;
int32_t contacts(void*, const rivulet_body_state*, const float*, size_t, double, rivulet_add_contact add, void* to) {
    if (fails == Fails::contacts) throw std::runtime_error("the engine lost its contacts");
    rivulet_body_contact floor{};
    floor.size = sizeof floor;
    floor.b = RIVULET_SOLID;
    floor.normal[1] = 1;
    for (int k = 0; k < (fails == Fails::adding ? 9999 : 1); ++k) {
        if (k == 999) allocationsLeft = 0;
        add(to, &floor);
    }
    allocationsLeft = -1;
    return 1;
}
void passed(void*, double) {
    if (fails == Fails::passed) throw std::runtime_error("the engine lost its clock");
}
void predict(void*, const rivulet_body_load*, const float*, double, double, rivulet_body_state*, size_t) {
    if (fails == Fails::predict) throw std::runtime_error("the engine sees nothing");
}

// What a step's error says of the bodies is where they are.
void theGpuMovesThem() {
    rivulet_context* context = nullptr;
    rivulet_context_options options{};
    options.size = sizeof options;
    options.backend = "cl";
    if (rivulet_context_create(&options, &context, &why) != RIVULET_OK) {
        printf("no device of OpenCL: %s\n", why.message);
        return;
    }
    rivulet_body_host host{};
    host.size = sizeof host;
    host.advance = stays;
    host.reset = reset;
    host.contacts = contacts;
    host.passed = passed;
    host.predict = predict;
    rivulet_body body = sampled(kSamples);
    body.pose.position[1] = 0.7F;
    rivulet_world_options scene{};
    scene.size = sizeof scene;
    scene.json = R"({"fluid": {"spacing": 0.05, "box": {"max": [0.5, 0.8, 0.5]}, "blocks": [{"max": [0.5, 0.1, 0.5]}]}})";
    scene.bodies = &body;
    scene.bodies_count = 1;
    scene.body_host = &host;
    rivulet_world* world = nullptr;
    DONE(rivulet_world_create(context, &scene, &world, &why));
    const std::pair<Fails, const char*> all[] = {
        {Fails::contacts, "body_host.contacts threw an exception: the engine lost its contacts; the bodies stay where they are"},
        {Fails::adding, "body_host.contacts added more contacts than there is memory for; the bodies stay where they are"},
        {Fails::passed, "body_host.passed threw an exception: the engine lost its clock; the GPU has moved the bodies nevertheless"},
        {Fails::predict, "body_host.predict threw an exception: the engine sees nothing; the bodies stay where they are"}};
    rivulet_body_state before, after;
    for (const auto& [what, sentence] : all) {
        DONE(rivulet_world_step(world, nullptr, 1.0 / 60, &why));
        DONE(rivulet_world_bodies(world, &before, 1, &why));
        fails = what;
        CHECK(rivulet_world_step(world, nullptr, 1.0 / 60, &why) == RIVULET_FAILED);
        fails = Fails::none;
        CHECK(strcmp(why.message, sentence) == 0);
        if (strcmp(why.message, sentence) != 0) printf("%s\n", why.message);
        DONE(rivulet_world_bodies(world, &after, 1, &why));
        const bool moved = strstr(sentence, "has moved") != nullptr;
        CHECK((after.pose.position[1] < before.pose.position[1]) == moved);
        CHECK(moved || memcmp(&before, &after, sizeof before) == 0);
        DONE(rivulet_world_step(world, nullptr, 1.0 / 60, &why));
        DONE(rivulet_world_bodies(world, &before, 1, &why));
        CHECK(before.pose.position[1] < after.pose.position[1]);  // it falls on
    }
    rivulet_world_destroy(world);
    rivulet_context_destroy(context);
}

}  // namespace

void* operator new(size_t bytes) { return allocated(bytes); }
void operator delete(void* memory) noexcept { std::free(memory); }
void operator delete(void* memory, size_t) noexcept { std::free(memory); }

int main() {
    rivulet_context* context = nullptr;
    rivulet_context_options options{};
    options.size = sizeof options;
    options.backend = "cpu";
    options.log = log;
    DONE(rivulet_context_create(&options, &context, &why));
    const float samples[6] = {0.02F, 0, 0, -0.02F, 0, 0};
    rivulet_body body{};
    body.size = sizeof body;
    body.samples = samples;
    body.samples_count = 2;
    body.mass = 0.1F;
    body.volume = 1e-4F;
    for (float& inertia : body.inertia) inertia = 1e-4F;
    for (float& x : body.pose.position) x = 0.7F;
    rivulet_body_host host{};
    host.size = sizeof host;
    host.advance = advance;
    host.reset = reset;
    rivulet_world_options scene{};
    scene.size = sizeof scene;
    scene.json = R"({"fluid": {"spacing": 0.05, "blocks": [{"max": [0.3, 0.3, 0.3]}]}})";
    scene.bodies = &body;
    scene.bodies_count = 1;
    scene.body_host = &host;
    rivulet_world* world = nullptr;
    DONE(rivulet_world_create(context, &scene, &world, &why));
    rivulet_body_state before, after;
    DONE(rivulet_world_step(world, nullptr, 1.0 / 60, &why));
    DONE(rivulet_world_bodies(world, &before, 1, &why));
    throws = true;
    CHECK(rivulet_world_step(world, nullptr, 1.0 / 60, &why) == RIVULET_FAILED && strstr(why.message, "out of fuel") != nullptr);
    DONE(rivulet_world_bodies(world, &after, 1, &why));
    CHECK(after.pose.position[1] == before.pose.position[1]);
    throws = false;
    rivulet_stats stats{};
    stats.size = sizeof stats;
    DONE(rivulet_world_stats(world, &stats, &why));
    CHECK(std::abs(stats.time - 2.0 / 60) < 1e-9 && stats.lost == 0);  // the water went on
    DONE(rivulet_world_step(world, nullptr, 1.0 / 60, &why));
    DONE(rivulet_world_bodies(world, &after, 1, &why));
    CHECK(after.pose.position[1] > before.pose.position[1]);
    throws = true;
    CHECK(rivulet_world_reset(world, &why) == RIVULET_FAILED && strstr(why.message, "body_host.reset threw") != nullptr);
    throws = false;
    DONE(rivulet_world_step(world, nullptr, 1.0 / 60, &why));
    rivulet_context_destroy(context);  // refused: it has a world
    CHECK(logged > 0);
    DONE(rivulet_world_step(world, nullptr, 1.0 / 60, &why));
    rivulet_world_destroy(world);
    memoryRunsOut(context);
    theEngineRefuses(context);
    nothingChangesInAStop(context);
    rivulet_context_destroy(context);
    theGpuMovesThem();
    printf("%s\n", failures == 0 ? "all holds" : "something does not hold");
    return failures == 0 ? 0 : 1;
}
