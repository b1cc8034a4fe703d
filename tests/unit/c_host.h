// CHost: a test that calls rivulet.h, with worlds on the cpu that are drawn into a HostScene.
#pragma once

#include <glm/gtc/type_ptr.hpp>
#include <type_traits>

#include "fluid/capi/rivulet.h"
#include "tests/unit/host_fixture.h"
#include "tests/unit/opengl_test.h"

namespace rivulet::testing {

class CHost : public OpenGlTest {
  protected:
    // `find`: as rivulet_context_options has it.
    void makeContext(rivulet_find_function find, rivulet_context*& context, bool plainState = false) {
        rivulet_context_options options{};
        options.size = sizeof options;
        options.find = find;
        options.backend = "cpu";
        options.plain_state = plainState ? 1 : 0;
        ASSERT_EQ(rivulet_context_create(&options, &context, &why_), RIVULET_OK) << why_.message;
    }
    // A block of water that is about to fall.
    void makeWorld(rivulet_context* context, rivulet_world*& world) {
        rivulet_world_options scene{};
        scene.size = sizeof scene;
        scene.json = R"({"fluid": {"spacing": 0.04, "blocks": [{"min": [0.1, 0, 0.2], "max": [0.9, 0.4, 0.8]}]}})";
        ASSERT_EQ(rivulet_world_create(context, &scene, &world, &why_), RIVULET_OK) << why_.message;
    }
    // A world or a snapshot, seen by the scene's camera or from `aside` of it, m.
    template <class Drawn>
    rivulet_status draw(Drawn* drawn, const HostScene& host, float aside = 0, const rivulet_renderer* renderer = nullptr) {
        FrameView v = host.view();
        v.view[3].x += aside;
        rivulet_view view{};
        view.size = sizeof view;
        view.view = glm::value_ptr(v.view);
        view.projection = glm::value_ptr(v.projection);
        view.near_plane = v.nearPlane;
        view.far_plane = v.farPlane;
        view.renderer = renderer;
        const HostTarget t = host.target();
        rivulet_target target{};
        target.size = sizeof target;
        target.framebuffer = t.framebuffer;
        target.width = t.width;
        target.height = t.height;
        if constexpr (std::is_same_v<Drawn, rivulet_world>)
            return rivulet_world_draw(drawn, &view, &target, &why_);
        else
            return rivulet_snapshot_draw(drawn, &view, &target, &why_);
    }

    rivulet_error why_{};
};

}  // namespace rivulet::testing
