// A C++ host whose callbacks throw: the call returns the exception's text, and the world goes on.
#include <cmath>
#include <stdexcept>

#include "check.h"

namespace {

rivulet_error why;
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

}  // namespace

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
    rivulet_context_destroy(context);
    printf("%s\n", failures == 0 ? "all holds" : "something does not hold");
    return failures == 0 ? 0 : 1;
}
