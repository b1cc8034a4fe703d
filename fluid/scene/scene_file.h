// A scene: one JSON file, every key with a default, so that the smallest scene is a few lines. +Y up, metres.
// Demos, golden images, physics cases, benches and fuzz seeds are all scenes.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "engine/core/params.h"
#include "engine/core/result.h"
#include "fluid/render/look_params.h"
#include "fluid/scene/body_params.h"
#include "fluid/scene/collider_params.h"
#include "fluid/scene/flow_params.h"
#include "fluid/scene/pour_params.h"
#include "fluid/sim/sources/emitter.h"
#include "fluid/sim/world/fluid_params.h"

namespace rivulet {

struct CameraParams {
    std::string from;                 // a camera of a collider's file; "" = the values below
    vec3 position{1.6F, 1.1F, 2.2F};  // m
    vec3 target{0.5F, 0.35F, 0.5F};   // m
    float fieldOfView = 40.0F;        // deg, vertical
    float exposure = 0.0F;            // stops
    float bloom = 0.0F;               // 0..1
    float aperture = 0.0F;            // f-number; 0 = everything is sharp
    float focus = 0.0F;               // m; 0 = that of what is in the middle of the picture
    void visit(ParamVisitor& v);
};

struct LightParams {
    std::string from;                   // a directional light of a collider's file; "" = the values below
    vec3 direction{0.72F, 0.8F, 0.1F};  // towards the light
    vec3 colour{1.0F, 0.96F, 0.9F};     // linear
    float intensity = 3.6F;
    float fill = 0.0F, rim = 0.0F;  // of the studio's softboxes beside and behind, as shares of the key light; 0: only reflected
    void visit(ParamVisitor& v);
};

struct BackgroundParams {
    vec3 horizon{0.40F, 0.44F, 0.48F};  // linear
    vec3 zenith{0.12F, 0.17F, 0.24F};
    vec3 floor{0.56F, 0.55F, 0.53F};  // the ground plane's colour
    float floorHeight = 0.0F;         // m
    float tiles = 0.0F;               // m, side of the ground's square tiles; 0: plain
    bool showFloor = true;
    bool showBox = true;             // edges of the fluid's box
    std::string sky = "studio";      // studio | clouds: the sky where `surroundings` is empty
    float clouds = 0.5F;             // share of a clouds sky that is covered
    std::string surroundings;        // an equirectangular picture (.hdr) instead of the studio; "" = none
    float surroundingsLevel = 1.0F;  // factor on it
    void visit(ParamVisitor& v);
};

// Limits on the cost of a frame and on the density error: a setting within both is picked (budget.h).
struct BudgetParams {
    float frameMs = 0;              // limit on simulating 1/60 s; 0 = no budget
    float maxDensityError = 0.01F;  // mean compression, a fraction
    float finest = 0;               // m, the finest spacing that is picked; 0 = fluid.spacing
    void visit(ParamVisitor& v);
};

// The paths in SceneFile::sliders.
std::vector<std::string> slidersOf(std::string_view list);

// The arguments of loadScene.
struct SceneSource {
    std::string path;  // of the file that was found; "": the scene is of no file
    std::string preset;
    std::vector<std::string> assignments;
};

struct SceneFile {
    std::string name = "unnamed";
    std::string doc;
    float duration = 5.0F;   // s
    float timeScale = 1.0F;  // simulated seconds per second shown; less than 1: slow motion
    FluidParams fluid;
    std::vector<ColliderParams> colliders;
    std::vector<EmitterParams> emitters;
    std::vector<SinkParams> sinks;
    std::vector<DryParams> dry;
    PourParams pour;
    std::vector<BodyParams> bodies;
    std::vector<FlowParams> flow;
    FluidLookParams look;
    CameraParams camera;
    LightParams light;
    BackgroundParams background;
    BudgetParams budget;
    std::vector<PresetParams> presets;
    std::string sliders;  // paths of the parameters that the window shows above all others, separated by ", "
    std::string folder;   // of the file it came from; not a Param
    SceneSource source;   // nor this
    uint32_t room = 0;    // nor this: least number of particles to reserve memory for, as Sources::least
    void visit(ParamVisitor& v);
};

// `path`: as of findAsset, or the name of a listed scene (`dam_break`). `assignments`: each --set, in order. Error: as of readJson and
// setParam.
// `preset`: the name of one of the scene's presets, set before the assignments; "" = none.
Result<SceneFile> loadScene(const std::string& path, std::span<const std::string> assignments, const std::string& preset = "");

// Writes what differs from the defaults. loadScene of the new file gives the same scene: a path that was relative to the old file and is
// not found from the new one becomes absolute, in `scene`, too. Error (failed): not writable, disk full; the old file stays.
Status saveScene(SceneFile& scene, const std::string& path);

// Sets the values of one of the scene's presets. Error (badInput): no such preset (the sentence lists those that exist); setParam refuses
// a value. The scene is unchanged then.
Status applyPreset(SceneFile& scene, const std::string& name);

// Error (badInput): values that contradict each other, each valid by itself. loadScene calls it; so must an editor of scenes.
Status checkScene(const SceneFile& scene);

// The first that exists of: `path` itself; `path` in the scene's folder, in the folders of RIVULET_ASSETS (separated by colons), in the
// assets/ of the source tree, in the installed assets/. Error (badInput): none exists; the sentence lists all places. Or as openInput.
Result<std::string> findAsset(const std::string& path, const std::string& sceneFolder);

// Every scene file found in the places that findAsset searches under scenes/, with its name and doc: in the order of scenes.txt above
// them, then by path. `missing`: a mesh or picture that it needs and that is not found; "" = it can run.
struct SceneListing {
    std::string path, name, doc, missing;
};
std::vector<SceneListing> listScenes();

}  // namespace rivulet
