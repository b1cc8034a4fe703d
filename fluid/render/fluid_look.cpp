#include "fluid/render/fluid_look.h"

namespace rivulet {

namespace {
constexpr ViewRow kViewRows[] = {
    {"water", "the water", WaterView::water},
    {"normals", "normals of the surface: x, y, z as red, green, blue", WaterView::normals},
    {"depth", "depth of the surface after the filter: white = near", WaterView::depth},
    {"spheres", "depth of the particles before the filter", WaterView::spheres},
    {"thickness", "thickness of the water along the line of sight", WaterView::thickness},
};
constexpr Table<ViewRow> kViews{kViewRows};
constexpr ColourRow kColourRows[] = {
    {"speed", "speed, up to 3 m/s", ColourBy::speed},
    {"density", "density, relative to the rest density", ColourBy::density},
    {"id", "a constant colour for each particle", ColourBy::id},
    {"dye", "absorption of the particle's liquid and dye", ColourBy::dye},
    {"normal", "normal of the surface: x, y, z as red, green, blue", ColourBy::normal, true},
    {"sleep", "blue: a particle that sleeps (fluid.sleep)", ColourBy::sleep},
    {"surface", "blue: a particle of the surface", ColourBy::surface, true},
};
constexpr Table<ColourRow> kColours{kColourRows};
}  // namespace

const Table<ViewRow>& waterViews() { return kViews; }
const Table<ColourRow>& colourings() { return kColours; }

}  // namespace rivulet
