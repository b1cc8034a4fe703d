// VoxelPanel: the voxels of a scene's meshes: a slice of materials or distances, and the list of materials.
#pragma once

#include <optional>
#include <string>

#include "engine/gpu/texture.h"
#include "fluid/session/session.h"
#include "fluid/voxel/labels.h"

namespace rivulet {

// Costs nothing while hidden. The regions of a field are found when it is first shown, a slice is drawn when it changes; both are repeated
// a few times a second for a deforming mesh.
class VoxelPanel {
  public:
    // Inside an ImGui window, `width` pixels across. `time`: s, simulated; a deforming mesh has another shape at another time. Needs a
    // current OpenGL context.
    void draw(const SolidFields& fields, double time, float width);
    void clear();  // the fields are replaced

  private:
    enum class Shown { materials, distance };
    const VoxelField* choose(const SolidFields& fields, float width);
    void clearShown(const VoxelField* field);
    void label(double time);
    void refresh(const VoxelField& field);
    void drawControls(const VoxelField& field, float width);
    void drawSliceImage(const VoxelField& field, float width);
    void drawMaterials(float width) const;

    int axis_ = 2;
    int at_[3] = {-1, -1, -1};           // voxels; -1: the middle
    int chosen_ = 0;                     // among the fields: static, moving, deforming
    const VoxelField* field_ = nullptr;  // that labels_ are of
    double labelledAt_ = 0;              // s, simulated
    double nextLook_ = 0;                // s, on ImGui's clock: time of the next check for changed shapes
    Shown shown_ = Shown::materials;
    std::optional<VoxelLabels> labels_;  // of the field's surface, by connectivity
    gpu::Texture slice_;
    bool stale_ = true;      // the slice's texture is not what should be shown
    std::string complaint_;  // why there is no picture
};

}  // namespace rivulet
