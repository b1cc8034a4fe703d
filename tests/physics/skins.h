// A flow on a shape, for tests.
#pragma once

#include <gtest/gtest.h>

#include "fluid/flow/surface_flow.h"
#include "fluid/validate/flow_shapes.h"

namespace rivulet {

inline SurfaceFlow flowOn(Device& device, const Shape& shape, const SurfaceFlowParams& params = {}) {
    Result<FlowMesh> mesh = makeFlowMesh(shape.view());
    EXPECT_TRUE(mesh) << (mesh ? "" : mesh.error().message);
    Result<SurfaceFlow> flow = SurfaceFlow::create(device, std::move(*mesh), params);
    EXPECT_TRUE(flow) << (flow ? "" : flow.error().message);
    return std::move(*flow);
}

}  // namespace rivulet
