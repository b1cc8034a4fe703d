// FlowComponent: a skin of a scene and the flow on it. Loads the mesh and its materials, deforms and moves it, emits drops from the scene's
// sources, steps the flow and draws its maps.
#pragma once

#include <memory>
#include <random>
#include <string>
#include <vector>

#include "engine/core/log.h"
#include "engine/scene/scene.h"
#include "fluid/flow/flow_layer.h"
#include "fluid/flow/flow_maps.h"
#include "fluid/flow/placed_flow.h"
#include "fluid/scene/eye_motion.h"
#include "fluid/scene/flow_params.h"
#include "fluid/scene/skin_model.h"

namespace rivulet {

class FlowComponent {
  public:
    // Adds its nodes to `scene`. `device` must outlive it. Error (badInput): a file that is missing or damaged, an unknown part or
    // morph, UVs that cover no texel, no eyes where a source needs them; (failed): out of memory.
    static Result<std::unique_ptr<FlowComponent>> create(const FlowParams& params, const std::string& sceneFolder, Device& device,
                                                         Scene& scene, const Log& log);
    // Applies the parameters that may change while it runs.
    void apply(const FlowParams& params);
    bool needsNew(const FlowParams& params) const;

    // Moves the skin to `time` + `seconds` and steps its flow. Drops that leave it or begin in the air are appended to `air`, in the
    // world's frame. Error (failed): out of memory.
    Status step(double time, double seconds, const vec3& gravity, std::vector<AirDrop>& air);
    void placeNode(Scene& scene) const;

    // Updates the layer. Needs a current OpenGL context.
    Status draw();

    // Its state, for one that was made with the same params, on any device.
    struct Snapshot;
    std::shared_ptr<const Snapshot> save() const;  // waits
    Status restore(const Snapshot& snapshot);      // error (failed): out of memory

    uint64_t emitted() const { return emitted_; }  // picolitres, by its sources; without drops that landed
    const SurfaceFlow& flow() const { return *flow_; }
    PlacedFlow& placed() { return *placed_; }
    const FlowParams& params() const { return params_; }
    const FlowMaps& maps() const { return *maps_; }  // in mode drops
    // As last drawn, in mode thesis; else of size 0.
    const ThesisPicture& picture() const { return picture_; }
    Bounds bounds() const { return placed_->bounds(); }  // m, world

    // Where tears and other spots start, on the skin as placed() last saw it; m, world.
    struct TearPoint {
        size_t source = 0;
        vec3 world{0.0F};
    };
    std::vector<TearPoint> tearPoints() const;
    // The place of the skin that a path through the world meets, as FlowSourceParams::position; nothing: none. Waits for the device.
    std::optional<vec3> placeMet(const dvec3& from, const dvec3& to);

  private:
    struct Source {
        double due = 0;  // picolitres
        bool begun = false;
        std::optional<SkinPoint> spot;  // of kind spot, at spotOf
        vec3 spotOf{0.0F};
        uint64_t gathered = 0;  // picolitres of a brim's next tear, where a person has moved its start
        std::mt19937 random;
    };
    struct Deformed {
        std::shared_ptr<Deformer> deformer;
        std::vector<int> morphOf;              // of each of params_.expression, or -1
        std::array<int, 2> brimMorph{-1, -1};  // brimLeft, brimRight: what goes with the content of a lid
        size_t morphs = 0;
        std::vector<mat4> bones;  // of the file's node pose
    };

    FlowComponent() = default;
    bool thesis() const { return params_.mode == "thesis"; }
    void drawThesis();
    Status layOut(ModelPart& skin, const Log& log);
    void findBlinks(const ModelPart& skin);
    Status addParts(Model& model, const ModelPart* skin, Scene& scene);
    Status prepareFlow(const Mesh& skin);
    Result<FoundFace> takeMarks(const SkinModel& skin, const std::string& sceneFolder);
    std::vector<SkinBrim> brims(const FlowMesh& mesh);
    Status readRegions(const std::string& sceneFolder, const Mesh& skin);
    std::vector<float> weightsAt(double time) const;
    void bend(double time);
    void lookIntoLids();
    void emit(double time, double seconds, std::vector<AirDrop>& air);
    void emitOne(const FlowSourceParams& source, Source& state, uint32_t picolitres, std::vector<AirDrop>& air);
    SkinPoint somewhere(const FlowSourceParams& source, Source& state);
    dmat4 worldAt(double time) const;
    std::vector<size_t> eyesOf(const FlowSourceParams& source) const;
    std::string faultOf(const FlowSourceParams& source) const;
    SkinPoint besideSpot(const FlowSourceParams& source, Source& state, const vec2& off);
    std::optional<size_t> movedEye(const FlowSourceParams& source) const;
    void noticeOnce(const std::string& sentence);

    FlowParams params_;
    Log log_;
    std::vector<std::string> noticed_;
    Bounds around_;  // bounds(), once a step
    Device* device_ = nullptr;
    int group_ = 0;  // the parent node of all parts, which follow it
    struct Look {
        Material material;
        bool visible = true;
    };
    std::vector<Look> looks_;  // of the parts, as the file and `hide` say
    std::vector<Deformed> deformed_;
    struct TurningEye {
        int node = 0;
        EyeTurns turns;
    };
    std::vector<TurningEye> turningEyes_;            // eyeballs and corneas
    std::array<std::vector<float>, 2> blinkShares_;  // of each of params_.expression, for the left and right eye; may be empty
    std::shared_ptr<const Deformer> skinDeformer_;   // null: the skin does not deform
    std::vector<vec2> uvs_;                          // 3 a triangle of the flow's mesh, until the maps are made; kept in mode thesis
    // Of a skin with new UVs: the file's, of its vertices, and the file's vertex of each that the skin has now.
    std::vector<vec2> maskUvs_;
    std::vector<uint32_t> maskOf_;
    std::optional<SurfaceFlow> flow_;
    std::optional<FlowMaps> maps_;
    ThesisPicture picture_;
    std::optional<FlowLayer> texture_;
    std::shared_ptr<Layer> layer_;
    std::optional<PlacedFlow> placed_;  // of flow_
    FaceMarks marks_;
    std::vector<Source> sources_;
    std::array<SkinPoint, 2> tears_{};     // of the left and right eye
    std::array<uint32_t, 3> brimBegin_{};  // places of the left, the right brim, and the end
    // 0..1: how full each lid is, as last known; the device may report to it when this is gone.
    std::shared_ptr<std::array<float, 2>> lidsFull_ = std::make_shared<std::array<float, 2>>();
    std::vector<double> areaTo_;  // running sum of the triangles' areas, m^2, weighted by how oily they are
    std::vector<uint8_t> oily_;   // of each place
    uint64_t emitted_ = 0;
    double acted_ = 0;  // s, of the expression
};

}  // namespace rivulet
