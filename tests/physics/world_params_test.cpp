// Params of a running world: fixed values stay, live values change; the gravity of the params holds unless a frame sets another.
#include <gtest/gtest.h>

#include <map>

#include "engine/core/param_fixed.h"
#include "engine/core/param_value.h"
#include "fluid/flow/surface_flow.h"
#include "tests/physics/worlds.h"
#include "tests/unit/voxel_test_meshes.h"

namespace rivulet::world_params_test {
namespace {

// Visits every value: writes its text down, or changes it to another that its range allows.
class EachValue final : public ParamVisitor {
  public:
    struct Seen {
        std::string text;
        bool fixed;
    };
    std::map<std::string, Seen> seen;
    bool change = false;

    void value(const ParamInfo& info, float& v) override { visited(info, v, other(info, v)); }
    void value(const ParamInfo& info, int& v) override { visited(info, v, static_cast<int>(other(info, static_cast<float>(v)))); }
    void value(const ParamInfo& info, bool& v) override { visited(info, v, !v); }
    void value(const ParamInfo& info, std::string& v) override { visited(info, v, v + "x"); }
    void value(const ParamInfo& info, vec3& v) override { visited(info, v, vec3(other(info, v.x), other(info, v.y), other(info, v.z))); }
    void colour(const ParamInfo& info, vec3& v) override { value(info, v); }
    void choice(const ParamInfo& info, std::string& v, std::span<const std::string> names) override {
        visited(info, v, v == names.back() ? names.front() : names.back());
    }

  protected:
    bool beginGroup(const ParamInfo& info) override {
        path_.push_back(path_.back() + info.name + ".");
        return true;
    }
    void endGroup() override { path_.pop_back(); }
    size_t beginList(const ParamInfo& info, size_t current) override {
        path_.push_back(path_.back() + info.name + ".");
        return current;
    }
    void beginItem(size_t index) override { path_.push_back(path_.back() + std::to_string(index) + "."); }
    void endItem() override { path_.pop_back(); }
    void endList() override { path_.pop_back(); }

  private:
    // Halfway to the end of the range that is farther away.
    static float other(const ParamInfo& info, float v) {
        const double end = info.max - double{v} > double{v} - info.min ? info.max : info.min;
        return static_cast<float>(std::abs(end - double{v}) < 1.5 ? end : 0.5 * (double{v} + end));
    }
    template <class T>
    void visited(const ParamInfo& info, T& v, const T& another) {
        if (change) v = another;
        seen[path_.back() + info.name] = {valueText(v), info.fixed};
    }
    std::vector<std::string> path_{""};
};

template <class P>
std::map<std::string, EachValue::Seen> valuesOf(P params, P* changed = nullptr) {
    EachValue each;
    each.change = changed != nullptr;
    params.visit(each);
    if (changed != nullptr) *changed = params;
    return each.seen;
}

template <class P>
void expectFixedKept(const P& before, const P& asked, const P& after) {
    const auto was = valuesOf(before), wanted = valuesOf(asked), is = valuesOf(after);
    ASSERT_EQ(was.size(), is.size());
    size_t fixed = 0, live = 0;
    for (const auto& [path, value] : is) {
        ASSERT_NE(was.at(path).text, wanted.at(path).text) << path << ": no other value was asked for";
        EXPECT_EQ(value.text, value.fixed ? was.at(path).text : wanted.at(path).text) << path;
        ++(value.fixed ? fixed : live);
    }
    EXPECT_GT(fixed, 0U);
    EXPECT_GT(live, 0U);
}

FluidParams small() {
    FluidParams p;
    p.spacing = 0.1F;
    p.blocks = {{.min = vec3(0.1F), .max = vec3(0.5F)}, {.min = vec3(0.6F), .max = vec3(0.9F)}};
    return p;
}

TEST(ParamsOfAWorld, FixedValuesStayAndLiveValuesChange) {
    auto device = cpu();
    auto world = makeWorld(*device, small());
    ASSERT_TRUE(world);
    const FluidParams before = world->params();
    FluidParams asked;
    valuesOf(before, &asked);
    const Status taken = world->setParams(asked);
    ASSERT_TRUE(taken) << taken.error().message;
    expectFixedKept(before, asked, world->params());
    asked.blocks.pop_back();
    ASSERT_TRUE(world->setParams(asked));
    EXPECT_EQ(world->params().blocks.size(), 2U) << "a fixed list keeps its length";
}

TEST(ParamsOfAFlow, FixedValuesStayAndLiveValuesChange) {
    auto device = cpu();
    const test::Mesh ball = test::makeSphere(vec3(0.0F), 0.05F);
    Result<FlowMesh> mesh = makeFlowMesh(ball.view());
    ASSERT_TRUE(mesh) << mesh.error().message;
    Result<SurfaceFlow> flow = SurfaceFlow::create(*device, std::move(*mesh), {});
    ASSERT_TRUE(flow) << flow.error().message;
    const SurfaceFlowParams before = flow->params();
    SurfaceFlowParams asked;
    valuesOf(before, &asked);
    const Status taken = flow->setParams(asked);
    ASSERT_TRUE(taken) << taken.error().message;
    expectFixedKept(before, asked, flow->params());
    EXPECT_EQ(flow->params().brimStarts, before.brimStarts);
}

TEST(ParamsOfAWorld, SetTheGravityOfFramesWithoutTheirOwn) {
    const auto fallen = [](const FluidInputs& inputs) {
        auto device = cpu();
        FluidParams p = small();
        p.gravity = vec3(5.0F, 0.0F, 0.0F);
        p.method = "wcsph";
        auto world = makeWorld(*device, p);
        for (int k = 0; k < 3; ++k) world->step(inputs, 1.0 / 60);
        const ParticleView v = world->particles();
        const std::vector<vec4> velocity = world->device().readAll<vec4>(*v.velocity, v.slots);
        vec3 mean(0.0F);
        for (const vec4& one : velocity) mean += vec3(one) / static_cast<float>(velocity.size());
        return mean;
    };
    EXPECT_GT(fallen({}).x, 0.1F);
    EXPECT_NEAR(fallen({}).y, 0.0F, 0.02F) << "nothing falls down";
    EXPECT_LT(fallen({.gravity = vec3(0.0F, -9.81F, 0.0F)}).y, -0.1F) << "a frame's own gravity comes first";
    EXPECT_EQ(fallen({}), fallen({.gravity = vec3(5.0F, 0.0F, 0.0F)}));
}

}  // namespace
}  // namespace rivulet::world_params_test
