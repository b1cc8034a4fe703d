#include "fluid/viewer/scene_tree.h"

#include <fmt/format.h>
#include <imgui.h>

#include <algorithm>
#include <filesystem>
#include <vector>

namespace rivulet {

namespace {

using Thing = Session::Thing;

class Tree {
  public:
    Tree(const Session& session, SceneFile& draft, Manipulator& hand) : session_(session), draft_(draft), hand_(hand) {}

    void meshes() {
        const std::vector<Node>& nodes = session_.solids().nodes();
        std::vector<std::vector<size_t>> children(nodes.size());
        std::vector<size_t> roots;
        for (size_t n = 0; n < nodes.size(); ++n)
            (nodes[n].parent < 0 ? roots : children[static_cast<size_t>(nodes[n].parent)]).push_back(n);
        for (const size_t root : roots) {
            const Thing thing = session_.thingOf(root);
            std::string path = "flow";
            bool* visible = nullptr;
            if (thing.kind == Thing::Kind::collider && thing.index < draft_.colliders.size()) {
                path = fmt::format("colliders[{}]", thing.index);
                visible = &draft_.colliders[thing.index].visible;
            } else if (thing.kind == Thing::Kind::body && thing.index < draft_.bodies.size()) {
                path = fmt::format("bodies[{}]", thing.index);
                visible = &draft_.bodies[thing.index].visible;
            }
            ImGui::PushID(static_cast<int>(root));
            if (visible != nullptr) {
                asks.edited = ImGui::Checkbox("##drawn", visible) || asks.edited;
                if (ImGui::IsItemHovered()) ImGui::SetTooltip("shown or hidden; water collides with it in both cases");
                ImGui::SameLine();
            }
            if (row(nodes[root].name, path, thing, !children[root].empty())) {
                for (const size_t child : children[root]) node(nodes, children, child);
                ImGui::TreePop();
            }
            ImGui::PopID();
        }
    }

    template <class Items>
    void rest(const char* list, const char* one, const Items& items, Thing::Kind kind) {
        for (size_t k = 0; k < items.size(); ++k) {
            ImGui::PushID(list);
            ImGui::PushID(static_cast<int>(k));
            row(fmt::format("{} {}", one, k), fmt::format("{}[{}]", list, k), {kind, k}, false);
            ImGui::PopID();
            ImGui::PopID();
        }
    }

    TreeAsks asks;

  private:
    // Whether it is unfolded, and TreePop is due.
    bool row(const std::string& name, const std::string& path, const Thing& thing, bool unfolds) {
        ImGuiTreeNodeFlags flags = ImGuiTreeNodeFlags_OpenOnArrow | ImGuiTreeNodeFlags_SpanAvailWidth;
        if (!unfolds) flags |= ImGuiTreeNodeFlags_Leaf | ImGuiTreeNodeFlags_NoTreePushOnOpen;
        if (thing.kind != Thing::Kind::none && thing == hand_.chosen()) flags |= ImGuiTreeNodeFlags_Selected;
        std::string label = std::filesystem::path(name).filename().string();
        if (thing.kind == Thing::Kind::collider && draft_.colliders.size() > 1) label += fmt::format(" {}", thing.index);
        if (thing.kind == Thing::Kind::body && draft_.bodies.size() > 1) label += fmt::format(" {}", thing.index);
        const bool open = ImGui::TreeNodeEx("##row", flags, "%s", label.empty() ? path.c_str() : label.c_str());
        if (ImGui::IsItemClicked() && !ImGui::IsItemToggledOpen()) {
            hand_.choose(thing);
            asks.find = path;
        }
        return open && unfolds;
    }

    static void node(const std::vector<Node>& nodes, const std::vector<std::vector<size_t>>& children, size_t n) {
        ImGui::PushID(static_cast<int>(n));
        ImGuiTreeNodeFlags flags = ImGuiTreeNodeFlags_OpenOnArrow | ImGuiTreeNodeFlags_SpanAvailWidth;
        if (children[n].empty()) flags |= ImGuiTreeNodeFlags_Leaf;
        if (ImGui::TreeNodeEx("##node", flags, "%s", nodes[n].name.empty() ? "(no name)" : nodes[n].name.c_str())) {
            for (const size_t child : children[n]) node(nodes, children, child);
            ImGui::TreePop();
        }
        ImGui::PopID();
    }

    const Session& session_;
    SceneFile& draft_;
    Manipulator& hand_;
};

}  // namespace

TreeAsks drawSceneTree(const Session& session, SceneFile& draft, Manipulator& hand) {
    // As high as it was the frame before; its own window, so that it ends where those of the parameters do.
    ImGuiStorage& kept = *ImGui::GetStateStorage();
    const ImGuiID id = ImGui::GetID("things");
    Tree tree(session, draft, hand);
    ImGui::BeginChild("tree", ImVec2(0, std::clamp(kept.GetFloat(id), ImGui::GetFrameHeight(), ImGui::GetFontSize() * 13)));
    if (ImGui::CollapsingHeader("objects###things")) {
        tree.meshes();
        tree.rest("emitters", "emitter", draft.emitters, Thing::Kind::emitter);
        tree.rest("sinks", "sink", draft.sinks, Thing::Kind::sink);
        tree.rest("fluid.blocks", "block of water", draft.fluid.blocks, Thing::Kind::none);
    }
    const float height = ImGui::GetCursorPosY() - ImGui::GetStyle().ItemSpacing.y;
    ImGui::EndChild();
    kept.SetFloat(id, height);
    return tree.asks;
}

}  // namespace rivulet
