// Normals of the surface, computed for display.
#pragma once

#include <string>

#include "engine/core/params.h"

namespace rivulet {

struct ForceRow;

namespace force_normals {

struct Params {
    std::string normals = "none";  // none | thesis | gradient
    void visit(ParamVisitor& v);
};
ForceRow row();

}  // namespace force_normals
}  // namespace rivulet
