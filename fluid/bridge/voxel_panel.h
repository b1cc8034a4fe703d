// The panel that shows the voxels of what stands still: a slice of bits, materials or distances, and the list of materials.
#pragma once

#include <optional>
#include <string>

#include "engine/gpu/texture.h"
#include "fluid/voxel/labels.h"
#include "fluid/voxel/voxel_field.h"

namespace rivulet {

// Folded it costs nothing; the regions of a field are found when it is first looked at, and a slice is drawn when it changes.
class VoxelPanel {
  public:
    // Inside an ImGui window, `width` pixels across. `field`: null or empty = the scene has none. Needs a current OpenGL context.
    void draw(const VoxelField* field, float width);
    void clear();  // the field is another from now on
    bool open() const { return open_; }

  private:
    enum class Shown { materials, distance };
    void refresh(const VoxelField& field);
    void drawControls(const VoxelField& field, float width);
    void drawSliceImage(const VoxelField& field, float width);
    void drawMaterials(float width) const;

    bool open_ = false;
    int axis_ = 2;
    int at_[3] = {-1, -1, -1};  // voxels; -1: the middle
    Shown shown_ = Shown::materials;
    std::optional<VoxelLabels> labels_;  // of the field's surface, by connectivity
    gpu::Texture slice_;
    bool stale_ = true;      // the slice's texture is not what should be shown
    std::string complaint_;  // why there is no picture
};

}  // namespace rivulet
