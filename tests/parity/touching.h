// Touching: one substep of bodies with contacts, by advance_touching alone.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "engine/compute/device.h"
#include "fluid/sim/solids/body_contacts.h"
#include "shaders/fluid/solids/body_state.h"
#include "shaders/fluid/world/step_params.h"

namespace rivulet {

struct Touching {
    std::vector<Body> bodies;
    std::vector<BodyContact> contacts;
    StepParams step{};
    float passed = 0;             // s, of the frame
    std::vector<BodyLoad> loads;  // of each body, or none
    std::vector<BodyPull> pulls;
    std::vector<DeviceBody> run(Device& device) const {
        const Define group{"LOCAL_SIZE", std::to_string(TOUCHING_GROUP)};
        const Result<Kernel> kernel = device.kernel("fluid/solids/advance_touching", std::span(&group, 1));
        EXPECT_TRUE(kernel) << (kernel ? "" : kernel.error().message);
        const ContactRows made = contactRows(contacts, std::vector<bool>(bodies.size(), true), {}, 0.1F);
        std::vector<DeviceBody> rows(bodies.size());
        std::vector<BodyMotion> motions(bodies.size());
        for (size_t k = 0; k < bodies.size(); ++k) {
            const BodyState& s = bodies[k].state;
            const quat& q = s.pose.rotation;
            rows[k].position = vec4(s.pose.position, 0.0F);
            rows[k].rotation = vec4(q.x, q.y, q.z, q.w);
            rows[k].velocity = vec4(s.velocity, 0.0F);
            rows[k].spin = vec4(s.spin, 0.0F);
            motions[k] = {vec4(bodies[k].shape.inertia, bodies[k].shape.mass),
                          vec4(0, 0, 0, 100),
                          0,
                          0,
                          static_cast<uint32_t>(bodies.size()),
                          made.slots[k],
                          vec4(0),
                          vec4(0)};
        }
        for (const BodyPull& p : pulls) {
            motions[p.body].grip = vec4(p.at, p.rate);
            motions[p.body].hand = vec4(p.to, p.most);
        }
        const auto upload = [&device]<class T>(const std::vector<T>& items) {
            Result<Buffer> buffer = device.allocate(std::max<size_t>(items.size(), 1) * sizeof(T));
            EXPECT_TRUE(buffer);
            if (!items.empty()) device.writeAll<T>(*buffer, items);
            return std::move(*buffer);
        };
        std::vector<LoadRow> loadRows(rows.size() * LOAD_THREADS);
        for (size_t k = 0; k < loads.size(); ++k) {
            loadRows[k * LOAD_THREADS] = {vec4(vec3(loads[k].force), 0.0F), vec4(vec3(loads[k].torque), 0.0F)};
            motions[k].samples = 1;
        }
        const Buffer onBodies = upload(loadRows), by = upload(motions), moved = upload(rows), pairs = upload(made.pairs),
                     contactRows = upload(made.contacts), colours = upload(made.colours),
                     states = upload(std::vector<ContactState>(made.contacts.size())),
                     before = upload(std::vector<ContactState>(made.contacts.size()));
        StepParams s = step;
        s.force = vec4(passed, 1, static_cast<float>(made.colourCount()), 1);
        device.run(*kernel, s, {&onBodies, &by, &moved, &pairs, &contactRows, &colours, &states, &before}, TOUCHING_GROUP);
        return device.readAll<DeviceBody>(moved, rows.size());
    }
};

}  // namespace rivulet
