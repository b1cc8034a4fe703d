// SceneSources: where water comes into a scene and where it leaves. Emitters, sinks, and the jet that a person pours.
#pragma once

#include <optional>

#include "fluid/scene/scene_file.h"
#include "fluid/sim/sources/emitter.h"

namespace rivulet {

class SceneSources {
  public:
    // Reads the meshes of emitters and blocks. Error (badInput): as importMesh.
    Status create(const SceneFile& scene);

    const Sources& ofWorld() const { return start_; }  // what a FluidWorld is made with
    Sources now(const SceneFile& scene) const;         // what may change while it runs
    static bool needsNew(const SceneFile& before, const SceneFile& scene);
    // The place (m, world) that the jet falls on; nothing: it is off. Whether that changes anything.
    bool pourOnto(const SceneFile& scene, const std::optional<vec3>& place);
    void setLeast(uint32_t particles) { start_.least = particles; }  // as Sources::least

  private:
    Sources start_;
    std::optional<vec3> target_;  // m, of the jet
};

}  // namespace rivulet
