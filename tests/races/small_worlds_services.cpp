// Small worlds of what a world does beside its steps: sources and exchange, foam, sleep, wetness, queries.
#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "tests/physics/baked_mesh.h"
#include "tests/races/small_worlds_parts.h"

namespace rivulet::races {

namespace {

// The sums of what is drawn about each particle: of free slots nothing is.
void addEllipsoids(FluidWorld& world, std::vector<float>& to) {
    const ParticleView view = world.particles();
    const std::vector<vec4> position = world.device().readAll<vec4>(*view.position, view.count);
    for (const Buffer* of : view.ellipsoids) {
        ASSERT_NE(of, nullptr);
        const std::vector<vec4> all = world.device().readAll<vec4>(*of, view.count);
        dvec4 sum(0.0);
        for (size_t k = 0; k < all.size(); ++k)
            if (!(position[k].w < 0)) sum += dvec4(all[k]);
        add(to, vec4(sum / static_cast<double>(view.count)));
    }
}

}  // namespace

// Emitters, sinks, dry volumes, attributes, watched volumes, exchange, ellipsoids of particles that come and go.
Answer sources(Device& device) {
    FluidParams p = column("pbf");
    p.attributes = {{.name = "team", .x = 1}, {.name = "age"}};
    p.maxParticles = 600;
    p.ellipsoids = true;
    Sources s;
    s.emitters.resize(2);
    s.emitters[0].params = {.litresPerSecond = 40, .position = vec3(0.4F, 0.35F, 0.15F), .radius = 0.06F};
    s.emitters[1].params = {.shape = "box", .litresPerSecond = 20, .position = vec3(0.4F, 0.1F, 0.1F), .size = vec3(0.1F), .liquid = "oil"};
    p.blocks[0].dye = vec3(0.5F, 1, 1);
    s.sinks.push_back({.shape = "sphere", .position = vec3(0.1F, 0.05F, 0.1F), .radius = 0.08F});
    s.dry.push_back({.shape = "ellipsoid", .position = vec3(0.2F, 0.25F, 0.2F), .size = vec3(0.12F)});
    s.expectedDeposit = 0.01;
    Answer a;
    auto world = make(device, p, {}, s);
    if (!world) return a;
    const Volume watched[] = {{1, Volume::box, vec3(0.2F), vec3(0.2F)}, {2, Volume::sphere, vec3(0.3F, 0.1F, 0.1F), {}, 0.1F}};
    EXPECT_TRUE(world->setVolumes(watched));
    size_t listed = 0;
    std::vector<ParticleClaim> claims;
    std::vector<uint32_t> claimed;
    for (int k = 0; k < 4; ++k) {
        if (k == 1) {
            EXPECT_TRUE(world->paint(0, watched[0], vec4(3.0F)));
            const uint32_t ids[] = {7, 3, 100};
            const vec4 values[] = {vec4(1.0F), vec4(2.0F), vec4(3.0F)};
            EXPECT_TRUE(world->setAttribute(1, ids, values));
            std::vector<uint32_t> slots;
            for (const WorldParticle& particle : world->within({vec3(0.0F), vec3(0.15F)})) slots.push_back(particle.slot);
            world->withdraw(slots);
            // The last claim is of a particle that is elsewhere.
            const Bounds claimable{vec3(0.15F, 0.0F, 0.0F), vec3(0.3F, 0.1F, 0.3F)};
            for (const WorldParticle& particle : world->within(claimable)) claims.push_back({particle.id, particle.position, kSpacing});
            std::ranges::sort(claims, {}, &ParticleClaim::id);
            if (!claims.empty()) claims.back().position.x += 1;
            world->withinLater(claimable, 0, 1.0e9F, [&](std::span<const WorldParticle> found) { listed = found.size(); });
            world->withdrawLater(claims, [&](std::span<const uint32_t> removed) { claimed.assign(removed.begin(), removed.end()); });
            world->deposit(vec3(0.45F, 0.2F, 0.2F), vec3(0, -1, 0), 0.0004);
        }
        step(*world);
    }
    EXPECT_GT(claims.size(), 4U);
    EXPECT_EQ(listed, claims.size());
    EXPECT_EQ(static_cast<size_t>(std::ranges::count(claimed, 1U)), claims.size() - 1);
    addMeans(*world, a.near);
    for (const VolumeCount& count : world->volumes()) a.near.push_back(0.001F * static_cast<float>(count.inside));
    addEllipsoids(*world, a.near);
    a.within = 0.01;
    // dfsph remembers the pressure of each particle, and forgets it where one is removed.
    Sources drain;
    drain.sinks = s.sinks;
    world = make(device, column("dfsph"), {}, drain);
    if (!world) return a;
    for (int k = 0; k < 2; ++k) step(*world);
    EXPECT_GT(world->stats().drained, 0);
    addParticles(*world, a.exact);
    return a;
}
// Drawn between steps of a fixed length.
Answer foam(Device& device) {
    FluidParams p = column("pbf");
    p.foam.most = 2000;
    p.foam.trappedAir = p.foam.waveCrest = 20000;
    p.foam.airFrom = p.foam.crestFrom = p.foam.speedFrom = 0.0F;
    p.foam.airTo = p.foam.crestTo = p.foam.speedTo = 0.05F;
    p.fixedStep = static_cast<float>(kStep);
    Answer a;
    auto world = make(device, p);
    if (!world) return a;
    for (int k = 0; k < 4; ++k) step(*world, {}, 1.1 * kStep);
    addParticles(*world, a.exact);
    const ParticleView view = world->particles();
    EXPECT_NE(view.foamDrawn, view.foam);
    for (const Buffer* of : {view.foam, view.foamDrawn}) {
        std::vector<vec4> cloud = device.readAll<vec4>(*of, view.foamSlots);
        std::erase_if(cloud, [](const vec4& x) { return !(x.w > 0); });
        EXPECT_GT(cloud.size(), 50U);
        addMeans(cloud, a.near);
    }
    a.within = 0.05;  // the random numbers of a foam particle are those of its slot
    return a;
}
Answer sleep(Device& device) {
    Answer a;
    for (const char* method : {"pbf", "dfsph", "wcsph"}) {
        FluidParams p = column(method);
        p.sleep = {.on = true, .speed = 1, .after = 0.5F};
        p.blocks[0].velocity = vec3(0.0F);
        p.blocks[0].max = vec3(0.5F, 0.2F, 0.3F);
        auto world = make(device, p);
        if (!world) return a;
        for (int k = 0; k < 6; ++k) step(*world, {}, 1.0 / 60);
        addParticles(*world, a.exact);
        a.exact.push_back(static_cast<float>(world->stats().asleep));
    }
    // A paddle moves at one end of a long tank: the water there wakes. Ellipsoids of what sleeps stay.
    FluidParams p = column("pbf");
    p.sleep = {.on = true, .speed = 1, .after = 0.5F};
    p.ellipsoids = true;
    p.box.max.x = 1.0F;
    p.blocks[0].velocity = vec3(0.0F);
    p.blocks[0].max = vec3(1.0F, 0.1F, 0.3F);
    const VoxelField paddle = test::baked(test::makeBox(vec3(-0.03F, -0.05F, -0.1F), vec3(0.03F, 0.05F, 0.1F)), 0.025F, kSpacing);
    Pose pose{vec3(0.08F, 0.2F, 0.15F)};
    auto world = make(device, p, {.rigid = {{&paddle, pose}}});
    if (!world) return a;
    for (int k = 0; k < 8; ++k) step(*world, {.poses = std::span(&pose, 1)}, 1.0 / 60);
    const uint32_t before = world->stats().asleep;
    pose.position.y -= 0.02F;
    step(*world, {.poses = std::span(&pose, 1)}, 1.0 / 60);
    const uint32_t after = world->stats().asleep;
    EXPECT_GT(after, 0U);
    EXPECT_LT(after, before);
    addParticles(*world, a.exact);
    addEllipsoids(*world, a.near);
    a.exact.push_back(static_cast<float>(before));
    a.exact.push_back(static_cast<float>(after));
    return a;
}
Answer wetness(Device& device) {
    FluidParams p = column("pbf");
    p.wetness = {.on = true, .dries = 1};
    const VoxelField pillar = test::baked(test::makeBox(vec3(-0.06F, -0.12F, -0.06F), vec3(0.06F, 0.12F, 0.06F)), 0.025F, kSpacing);
    Pose pose{vec3(0.25F, 0.2F, 0.15F)};
    Answer a;
    auto world = make(device, p, {.field = &pillar, .rigid = {{&pillar, pose}}});
    if (!world) return a;
    for (int k = 0; k < 3; ++k) {
        pose.position.y += 0.01F;
        step(*world, {.poses = std::span(&pose, 1)});
    }
    addParticles(*world, a.exact);
    const WetnessView wet = world->wetness();
    const std::vector<float> values = device.readAll<float>(*wet.values, wet.surface->points.size());
    a.exact.insert(a.exact.end(), values.begin(), values.end());
    return a;
}
Answer queries(Device& device) {
    Answer a;
    for (const char* grid : {"sorted", "linked_list"}) {
        if (device.backend() == Backend::cpu && grid != std::string("sorted")) continue;
        FluidParams p = column(grid == std::string("sorted") ? "pbf" : "wcsph_thesis");
        p.grid = grid;
        p.ellipsoids = grid == std::string("sorted");
        auto world = make(device, p);
        if (!world) return a;
        step(*world);
        std::vector<vec3> places;
        std::vector<FluidRay> rays;
        for (int k = 0; k < 12; ++k) {
            places.emplace_back(0.04F * static_cast<float>(k), 0.03F * static_cast<float>(k), 0.02F * static_cast<float>(k));
            rays.push_back({vec3(0.25F, 0.4F, 0.15F), places.back() - vec3(0.25F, 0.4F, 0.15F)});
        }
        std::vector<float>& to = grid == std::string("sorted") ? a.exact : a.near;
        const auto samples = world->sample(places);
        EXPECT_TRUE(samples);
        for (const FluidSample& s : *samples) {
            to.push_back(s.density);
            add(to, s.velocity);
        }
        const auto hits = world->cast(rays);
        EXPECT_TRUE(hits);
        for (const FluidHit& h : *hits) to.push_back(h.hit ? h.distance : -1.0F);
    }
    return a;
}

}  // namespace rivulet::races
