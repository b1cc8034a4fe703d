#include "fluid/viewer/tear_points.h"

#include <imgui.h>

#include <algorithm>

#include "fluid/viewer/manipulator.h"

namespace rivulet {

namespace {

constexpr float kReach = 12;  // px, around a point
constexpr float kFar = 160;   // px, from which the rings appear

}  // namespace

// On a GPU this waits; it is asked for while the mouse is over the picture of a scene with skins.
std::vector<TearPoints::Point> TearPoints::pointsOf(const Camera& camera, Session& session, const vec2& size) {
    std::vector<Point> points;
    const auto& skins = session.flows().skins();
    for (size_t k = 0; k < skins.size(); ++k)
        for (const FlowComponent::TearPoint& p : skins[k]->tearPoints()) {
            const vec3 towards = glm::normalize(camera.position - p.world);
            const auto seen = seenAt(camera, p.world, size);
            // A point behind the head has no ring.
            const auto first =
                skins[k]->placed().meets(dvec3(p.world + 0.5e-3F * towards), dvec3(camera.position), skins[k]->placed().time());
            if (seen && !first) points.push_back({k, p.source, *seen});
        }
    return points;
}

bool TearPoints::take(const InputEvents& input, const Camera& camera, Session& session, SceneFile& draft, bool& edited) {
    if (session.flows().empty() || session.replaying() != nullptr) {
        held_.reset();
        return false;
    }
    const vec2 size(glm::max(input.size, ivec2(1)));
    if (input.pressed(MouseButton::left)) {
        float least = kReach;
        for (const Point& p : pointsOf(camera, session, size))
            if (const float d = glm::distance(p.at, input.mouse); d < least) {
                least = d;
                held_ = p;
            }
    }
    if (!held_) return false;
    const auto& skins = session.flows().skins();
    if (held_->skin >= skins.size() || held_->skin >= draft.flow.size() || held_->source >= draft.flow[held_->skin].sources.size()) {
        held_.reset();
        return false;
    }
    held_->at = input.mouse;
    if (input.mouseDelta != vec2(0.0F)) {
        const ViewRay ray = rayThrough(camera, input.mouse, size);
        if (const auto place = skins[held_->skin]->placeMet(dvec3(ray.origin), dvec3(ray.origin + ray.direction))) {
            draft.flow[held_->skin].sources[held_->source].position = glm::round(*place * 1.0e4F) * 1.0e-4F;
            edited = true;
        }
    }
    if (!input.down(MouseButton::left)) held_.reset();
    return true;
}

void TearPoints::draw(const InputEvents& input, const Camera& camera, Session& session) const {
    if (session.flows().empty() || session.replaying() != nullptr || (input.mouse == vec2(0.0F) && !held_)) return;
    const vec2 size(glm::max(input.size, ivec2(1)));
    const float scale = size.x / std::max(ImGui::GetIO().DisplaySize.x, 1.0F);  // window coordinates in one of ImGui's
    ImDrawList& list = *ImGui::GetBackgroundDrawList();
    const auto ring = [&](const vec2& at, bool bright) {
        const ImVec2 centre(at.x / scale, at.y / scale);
        list.AddCircle(centre, 8, IM_COL32(20, 20, 20, bright ? 160 : 60), 0, 4);
        list.AddCircle(centre, 8, IM_COL32(255, 210, 90, bright ? 255 : 110), 0, 2);
    };
    if (held_) return ring(held_->at, true);
    for (const Point& p : pointsOf(camera, session, size)) {
        const float d = glm::distance(p.at, input.mouse);
        if (d < kFar) ring(p.at, d < kReach);
    }
}

}  // namespace rivulet
