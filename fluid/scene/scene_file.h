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
    std::string from;                 // a camera of a collider's file; "" = as the rest says
    vec3 position{1.6F, 1.1F, 2.2F};  // m
    vec3 target{0.5F, 0.35F, 0.5F};   // m
    float fieldOfView = 40.0F;        // deg, vertical
    void visit(ParamVisitor& v);
};

struct LightParams {
    std::string from;                   // a directional light of a collider's file; "" = as the rest says
    vec3 direction{0.72F, 0.8F, 0.1F};  // towards the light
    vec3 colour{1.0F, 0.96F, 0.9F};     // linear
    float intensity = 3.6F;
    void visit(ParamVisitor& v);
};

struct BackgroundParams {
    vec3 horizon{0.40F, 0.44F, 0.48F};  // linear
    vec3 zenith{0.12F, 0.17F, 0.24F};
    vec3 floor{0.56F, 0.55F, 0.53F};  // the ground plane's colour
    float floorHeight = 0.0F;         // m
    bool showFloor = true;
    bool showBox = true;             // edges of the fluid's box
    std::string sky = "studio";      // studio | clouds: what there is where no picture surrounds the scene
    float clouds = 0.5F;             // share of such a sky that they cover
    std::string surroundings;        // an equirectangular picture (.hdr) instead of the studio; "" = none
    float surroundingsLevel = 1.0F;  // factor on it
    void visit(ParamVisitor& v);
};

// What a frame may take, and how far density may be off: a setting that holds both is picked (budget.h).
struct BudgetParams {
    float frameMs = 0;              // what simulating a sixtieth of a second may take; 0 = no budget
    float maxDensityError = 0.01F;  // mean compression, a fraction
    float finest = 0;               // m, spacing that nothing finer is picked than; 0 = fluid.spacing
    void visit(ParamVisitor& v);
};

// What loadScene was given.
struct SceneSource {
    std::string path;  // of the file that was found; "": the scene came from none
    std::string preset;
    std::vector<std::string> assignments;
};

struct SceneFile {
    std::string name = "unnamed";
    std::string doc;
    float duration = 5.0F;   // s
    float timeScale = 1.0F;  // simulated seconds in a second of what is shown; less than 1: slow motion
    FluidParams fluid;
    std::vector<ColliderParams> colliders;
    std::vector<EmitterParams> emitters;
    std::vector<SinkParams> sinks;
    PourParams pour;
    std::vector<BodyParams> bodies;
    std::vector<FlowParams> flow;
    FluidLookParams look;
    CameraParams camera;
    LightParams light;
    BackgroundParams background;
    BudgetParams budget;
    std::vector<PresetParams> presets;
    std::string folder;  // of the file it came from; not a Param
    SceneSource source;  // nor this
    uint32_t room = 0;   // nor this: particles there is room for at least, as Sources::least
    void visit(ParamVisitor& v);
};

// `path`: as findAsset takes it, or the name of a listed scene (`dam_break`). `assignments`: each --set, in order. Error: as readJson and
// setParam say.
// `preset`: one of the scene's, set before the assignments; "" = none.
Result<SceneFile> loadScene(const std::string& path, std::span<const std::string> assignments, const std::string& preset = "");

// Writes what differs from the defaults, so that loadScene gives the same scene: what it found beside the old file and would not beside
// the new one is named by its whole path, in `scene`, too. Error (failed): not writable, disk full; what was there stays.
Status saveScene(SceneFile& scene, const std::string& path);

// Sets what one of its presets says. Error (badInput): no such preset, and which there are; a value that setParam refuses: all is as it
// was then.
Status applyPreset(SceneFile& scene, const std::string& name);

// Error: values that make no sense together, each fine by itself. loadScene asks it; who edits a scene asks it too.
Status checkScene(const SceneFile& scene);

// Where an asset is: `path` as given, beside the scene, in RIVULET_ASSETS, in the source tree's or the installed assets/. Error: every
// place looked at.
Result<std::string> findAsset(const std::string& path, const std::string& sceneFolder);

// Every scene file found in the places that findAsset searches under scenes/, with its name and doc.
struct SceneListing {
    std::string path, name, doc;
};
std::vector<SceneListing> listScenes();

}  // namespace rivulet
