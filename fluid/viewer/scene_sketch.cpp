#include "fluid/viewer/scene_sketch.h"

#include <imgui.h>

#include "fluid/scene/scene_file.h"
#include "fluid/session/scene_renderer.h"

namespace rivulet {

SceneSketch::SceneSketch(const std::string& path, float shape) : shape_(shape) {
    const Result<SceneFile> scene = loadScene(path, {});
    if (!scene) return;
    const BoxParams& box = scene->fluid.box;
    const Camera camera = cameraOf(scene->camera, {box.min, box.max});
    const mat4 onto = camera.projection(1 / shape) * camera.view();
    add(onto, box.min, box.max, Of::box);
    for (const ColliderParams& each : scene->colliders)
        if (each.fitSize > 0) add(onto, each.position - 0.5F * vec3(each.fitSize), each.position + 0.5F * vec3(each.fitSize), Of::solid);
    for (const BlockParams& each : scene->fluid.blocks) add(onto, each.min, each.max, Of::water);
}

void SceneSketch::add(const mat4& onto, const vec3& low, const vec3& high, Of of) {
    for (int axis = 0; axis < 3; ++axis)
        for (const float at : {low[axis], high[axis]}) {
            Face face{.corners = {}, .of = of};
            bool seen = true;
            for (int k = 0; k < 4; ++k) {
                vec3 corner(at);
                const int u = (axis + 1) % 3, v = (axis + 2) % 3;
                corner[axis] = at;
                corner[u] = k == 0 || k == 3 ? low[u] : high[u];
                corner[v] = k < 2 ? low[v] : high[v];
                const vec4 clip = onto * vec4(corner, 1.0F);
                seen = seen && clip.w > 0;
                face.corners[k] = vec2(0.5F + 0.5F * clip.x / clip.w, shape_ * (0.5F - 0.5F * clip.y / clip.w));
            }
            if (seen) faces_.push_back(face);
        }
}

void SceneSketch::draw(ImDrawList& list, const vec2& corner, float width) const {
    list.PushClipRect(ImVec2(corner.x, corner.y), ImVec2(corner.x + width, corner.y + shape_ * width), true);
    for (const Face& face : faces_) {
        ImVec2 p[4];
        for (int k = 0; k < 4; ++k) p[k] = ImVec2(corner.x + width * face.corners[k].x, corner.y + width * face.corners[k].y);
        const ImU32 line = face.of == Of::box ? IM_COL32(150, 165, 180, 90) : IM_COL32(200, 215, 225, 150);
        if (face.of != Of::box)
            list.AddConvexPolyFilled(p, 4, face.of == Of::water ? IM_COL32(60, 150, 190, 70) : IM_COL32(150, 140, 130, 50));
        list.AddPolyline(p, 4, line, ImDrawFlags_Closed, 1);
    }
    list.PopClipRect();
}

}  // namespace rivulet
