// Animations, cameras and lights of a model file, against positions computed by hand; also FBX and OBJ files.
#include "engine/scene/animation.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "engine/compute/device_cpu.h"
#include "engine/scene/import_model.h"
#include "engine/scene/skin.h"
#include "engine/scene/transform.h"
#include "fluid/sim/world/cpu_kernels.h"
#include "tests/unit/gltf_file.h"
#include "tests/unit/program_runner.h"

namespace rivulet::scene_animation_test {
namespace {

using testing::Scratch;

constexpr float kHalf = 0.70710678F;  // sine and cosine of 45 degrees

void expectNear(const vec3& a, const vec3& b, float within = 1.0e-5F) {
    EXPECT_LT(glm::distance(a, b), within) << a.x << " " << a.y << " " << a.z;
}

int nodeCalled(const Model& model, const std::string& name) {
    for (size_t k = 0; k < model.nodes.size(); ++k)
        if (model.nodes[k].name == name) return static_cast<int>(k);
    ADD_FAILURE() << "no node " << name;
    return 0;
}

// A mast that goes 2 m along x in a second, then 4 m up in two; on it, 1 m along x and twice as large, a jib that turns a quarter about z
// in two seconds.
std::string crane(const Scratch& scratch) {
    GltfFile file;
    const std::string mesh = file.box(0, 1, 0, 1, 0, 1);
    const int t3 = file.floats("SCALAR", {0, 1, 3}), way = file.floats("VEC3", {0, 0, 0, 2, 0, 0, 2, 4, 0});
    const int t2 = file.floats("SCALAR", {0, 2}), turn = file.floats("VEC4", {0, 0, 0, 1, 0, 0, kHalf, kHalf});
    return file.write(scratch.path(), "crane",
                      fmt::format(R"("scenes":[{{"nodes":[0,2,3]}}],
"nodes":[{{"name":"mast","children":[1]}},{{"name":"jib","mesh":0,"translation":[1,0,0],"scale":[2,2,2]}},
{{"name":"eye","camera":0,"translation":[0,1,5]}},{{"name":"lamp","rotation":[-{5},0,0,{5}],"extensions":{{"KHR_lights_punctual":{{"light":0}}}}}}],
"cameras":[{{"type":"perspective","perspective":{{"yfov":0.5,"aspectRatio":1.5,"znear":0.1}}}}],
"extensionsUsed":["KHR_lights_punctual"],"extensions":{{"KHR_lights_punctual":{{"lights":[{{"type":"directional","color":[1,0.5,0.25],"intensity":2}}]}}}},
"meshes":[{0}],"animations":[{{"name":"lift","samplers":[{{"input":{1},"output":{2}}},{{"input":{3},"output":{4}}}],
"channels":[{{"sampler":0,"target":{{"node":0,"path":"translation"}}}},{{"sampler":1,"target":{{"node":1,"path":"rotation"}}}}]}}])",
                                  mesh, t3, way, t2, turn, kHalf));
}

TEST(SceneAnimation, ANodeHasTheTransformOfItsKeysAndParents) {
    const Scratch scratch;
    const Result<Model> model = importModel(crane(scratch));
    ASSERT_TRUE(model) << model.error().message;
    ASSERT_EQ(model->clips.size(), 1U);
    const Clip& clip = model->clips[0];
    EXPECT_EQ(clip.name, "lift");
    EXPECT_NEAR(clip.seconds, 3.0, 1e-6);
    const auto jib = static_cast<size_t>(nodeCalled(*model, "jib"));
    EXPECT_EQ(model->nodes[static_cast<size_t>(model->nodes[jib].parent)].name, "mast");
    for (const auto& [time, mast] : {std::pair(-1.0, vec3(0, 0, 0)), std::pair(0.0, vec3(0, 0, 0)), std::pair(0.5, vec3(1, 0, 0)),
                                     std::pair(1.0, vec3(2, 0, 0)), std::pair(2.0, vec3(2, 2, 0)), std::pair(9.0, vec3(2, 4, 0))}) {
        const mat4 world = model->worldMatrices(nodesAt(*model, clip, time))[jib];
        const float angle = kPi / 4 * static_cast<float>(std::clamp(time, 0.0, 2.0));
        expectNear(transformPoint(world, vec3(0, 0, 0)), mast + vec3(1, 0, 0));
        expectNear(transformPoint(world, vec3(1, 0, 0)), mast + vec3(1, 0, 0) + 2.0F * vec3(std::cos(angle), std::sin(angle), 0));
    }
}

// A lift with the given `interpolation` between keys; `output` has a key's numbers in a row.
std::string lift(const Scratch& scratch, const std::string& interpolation, const std::vector<float>& output) {
    GltfFile file;
    const std::string mesh = file.box(0, 1, 0, 1, 0, 1);
    const int times = file.floats("SCALAR", {0, 1, 3}), way = file.floats("VEC3", output);
    return file.write(scratch.path(), "lift_" + interpolation,
                      fmt::format(R"("scenes":[{{"nodes":[0]}}],"nodes":[{{"name":"lift","mesh":0}}],"meshes":[{0}],
"animations":[{{"name":"up","samplers":[{{"input":{1},"output":{2},"interpolation":"{3}"}}],
"channels":[{{"sampler":0,"target":{{"node":0,"path":"translation"}}}}]}}])",
                                  mesh, times, way, interpolation));
}

vec3 liftedTo(const Model& model, double time) {
    return transformPoint(model.worldMatrices(nodesAt(model, model.clips[0], time))[static_cast<size_t>(nodeCalled(model, "lift"))],
                          vec3(0));
}

// What assimp 5.2 hands over of STEP and CUBICSPLINE are their keys alone, without the tangents: they are exact there, and straight
// between.
TEST(SceneAnimation, KeysAreExact) {
    const Scratch scratch;
    for (const auto& [kind, output] :
         {std::pair<const char*, std::vector<float>>("STEP", {0, 0, 0, 0, 2, 0, 0, 5, 0}),
          std::pair<const char*, std::vector<float>>("CUBICSPLINE",
                                                     {9, 9, 9, 0, 0, 0, 0, 3, 0, 0, 1, 0, 0, 2, 0, 0, -2, 0, 0, 0, 0, 0, 5, 0, 9, 9, 9})}) {
        const Result<Model> model = importModel(lift(scratch, kind, output));
        ASSERT_TRUE(model) << model.error().message;
        ASSERT_EQ(model->clips.size(), 1U);
        EXPECT_NEAR(model->clips[0].seconds, 3.0, 1e-6);
        for (const auto& [time, y] :
             {std::pair(0.0, 0.0F), std::pair(0.5, 1.0F), std::pair(1.0, 2.0F), std::pair(2.0, 3.5F), std::pair(3.0, 5.0F)})
            expectNear(liftedTo(*model, time), vec3(0, y, 0));
    }
}

// The weights of a mesh while no clip sets others.
TEST(SceneAnimation, AMeshRestsWithItsFilesMorphs) {
    const Scratch scratch;
    GltfFile file;
    std::vector<float> rise(24, 0.0F), widen(24, 0.0F);
    for (size_t k = 0; k < 8; ++k) {
        rise[3 * k + 1] = k < 4 ? 0.0F : 1.0F;  // the corners with z 1
        widen[3 * k] = 2.0F;
    }
    const int a = file.floats("VEC3", rise), b = file.floats("VEC3", widen);
    std::string mesh = file.box(0, 1, 0, 1, 0, 1, fmt::format(R"(,"targets":[{{"POSITION":{}}},{{"POSITION":{}}}])", a, b));
    mesh.insert(1, R"("weights":[0.5,0.25],)");
    const int times = file.floats("SCALAR", {0, 1}), weights = file.floats("SCALAR", {0, 1, 1, 1});
    const std::string animation = fmt::format(
        R"("animations":[{{"name":"w","samplers":[{{"input":{},"output":{}}}],"channels":[{{"sampler":0,"target":{{"node":0,"path":"weights"}}}}]}}],)",
        times, weights);
    const Result<Model> model = importModel(
        file.write(scratch.path(), "rests",
                   fmt::format(R"({}"scenes":[{{"nodes":[0]}}],"nodes":[{{"name":"m","mesh":0}}],"meshes":[{}])", animation, mesh)));
    ASSERT_TRUE(model) << model.error().message;
    ASSERT_EQ(model->parts.size(), 1U);
    const ModelPart& part = model->parts[0];
    const Bounds rests = part.mesh.bounds();
    expectNear(rests.min, vec3(0.5F, 0, 0));
    expectNear(rests.max, vec3(1.5F, 1.5F, 1));
    // A clip's weights are all there is then.
    ASSERT_EQ(model->clips.size(), 1U);
    auto device = makeCpuDevice(cpuKernels());
    auto bent = Deformer::create(*device, part);
    ASSERT_TRUE(bent) << bent.error().message;
    for (const auto& [time, low, high] : {std::tuple(0.0, vec3(2, 0, 0), vec3(3, 1, 1)), std::tuple(1.0, vec3(2, 0, 0), vec3(3, 2, 1))}) {
        bent->run(morphsAt(part, model->clips[0], time), {});
        Bounds all;
        std::vector<vec4> now(part.mesh.positions.size());
        device->read(bent->positions(), std::as_writable_bytes(std::span(now)), 0);
        for (const vec4& p : now) all.add(vec3(p));
        expectNear(all.min, low);
        expectNear(all.max, high);
    }
}

TEST(SceneAnimation, CamerasAndLightsAreTheFiles) {
    const Scratch scratch;
    const Result<Model> model = importModel(crane(scratch));
    ASSERT_TRUE(model) << model.error().message;
    ASSERT_EQ(model->cameras.size(), 1U);
    const ModelCamera& camera = model->cameras[0];
    EXPECT_EQ(camera.name, "eye");
    EXPECT_NEAR(camera.fieldOfView, 0.5F * 180 / kPi, 1e-3F);  // vertical, whatever the aspect
    const mat4 toWorld = model->worldMatrices()[static_cast<size_t>(camera.node)];
    expectNear(transformPoint(toWorld, camera.position), vec3(0, 1, 5));
    expectNear(mat3(toWorld) * camera.direction, vec3(0, 0, -1));
    ASSERT_EQ(model->lights.size(), 1U);
    const ModelLight& light = model->lights[0];
    EXPECT_EQ(light.name, "lamp");
    expectNear(light.colour, vec3(2, 1, 0.5F));
    // -z turned by -90 degrees about x is -y: it shines down.
    expectNear(mat3(model->worldMatrices()[static_cast<size_t>(light.node)]) * light.direction, vec3(0, -1, 0));
}

// A bar from y = 0 to 2 whose upper corners a bone at y = 1 holds, half or whole; a morph lifts corner 0 by 1 m along z.
std::string bar(const Scratch& scratch) {
    GltfFile file;
    const int weights =
        file.floats("VEC4", {1, 0, 0, 0, 1, 0, 0, 0, 0.5F, 0.5F, 0, 0, 0, 1, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 0.5F, 0.5F, 0, 0, 0, 1, 0, 0});
    std::vector<uint8_t> joints;
    for (int k = 0; k < 8; ++k) joints.insert(joints.end(), {0, 1, 0, 0});
    const int joint = file.bytes("VEC4", joints);
    std::vector<float> lift(24, 0.0F);
    lift[2] = 1;
    const int morph = file.floats("VEC3", lift);
    const std::string mesh = file.box(-0.5F, 0.5F, 0, 2, -0.5F, 0.5F, fmt::format(R"(,"targets":[{{"POSITION":{}}}])", morph));
    std::string held = mesh;
    held.insert(held.find("\"POSITION\""), fmt::format(R"("WEIGHTS_0":{},"JOINTS_0":{},)", weights, joint));
    const int bind = file.floats("MAT4", {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, -1, 0, 1});
    const int t = file.floats("SCALAR", {0, 2}), turn = file.floats("VEC4", {0, 0, 0, 1, 0, 0, 1, 0}),
              amount = file.floats("SCALAR", {0, 1});
    return file.write(scratch.path(), "bar",
                      fmt::format(R"("scenes":[{{"nodes":[0,1]}}],
"nodes":[{{"name":"root","children":[2]}},{{"name":"bar","mesh":0,"skin":0}},{{"name":"tip","translation":[0,1,0]}}],
"skins":[{{"joints":[0,2],"inverseBindMatrices":{1}}}],"meshes":[{0}],
"animations":[{{"name":"bend","samplers":[{{"input":{2},"output":{3}}},{{"input":{2},"output":{4}}}],
"channels":[{{"sampler":0,"target":{{"node":2,"path":"rotation"}}}},{{"sampler":1,"target":{{"node":1,"path":"weights"}}}}]}}])",
                                  held, bind, t, turn, amount));
}

TEST(SceneAnimation, AVertexIsBetweenThePlacesOfItsBones) {
    const Scratch scratch;
    Result<Model> model = importModel(bar(scratch));
    ASSERT_TRUE(model) << model.error().message;
    const Clip& clip = model->clips.at(0);
    ModelPart& part = model->parts.at(0);
    ASSERT_EQ(part.morphs.size(), 1U);
    EXPECT_EQ(part.morphs[0].vertices, std::vector<uint32_t>{0});
    ASSERT_EQ(clip.morphs.size(), 1U);
    EXPECT_EQ(morphsAt(part, clip, 1.0), std::vector<float>{0.5F});
    const auto device = makeCpuDevice(cpuKernels());
    Result<Deformer> deformer = Deformer::create(*device, part);
    ASSERT_TRUE(deformer) << deformer.error().message;
    for (const double time : {0.0, 0.5, 1.0, 2.0}) {
        const std::vector<mat4> world = model->worldMatrices(nodesAt(*model, clip, time));
        deformer->run(morphsAt(part, clip, time), model->boneMatrices(part, world));
        std::vector<vec4> now(part.mesh.positions.size());
        device->read(deformer->positions(), std::as_writable_bytes(std::span(now)), 0);
        const float angle = kPi / 2 * static_cast<float>(time), share = 0.5F * static_cast<float>(time);
        for (size_t v = 0; v < now.size(); ++v) {
            const vec3 rest = part.mesh.positions[v] + (v == 0 ? vec3(0, 0, share) : vec3(0.0F));
            const vec3 arm = rest - vec3(0, 1, 0);
            const vec3 turned = vec3(0, 1, 0) + vec3(std::cos(angle) * arm.x - std::sin(angle) * arm.y,
                                                     std::sin(angle) * arm.x + std::cos(angle) * arm.y, arm.z);
            const float tip = (v & 2U) == 0 ? 0.0F : (v & 1U) == 0 ? 0.5F : 1.0F;  // as the file's weights
            expectNear(vec3(now[v]), glm::mix(rest, turned, tip), 1.0e-4F);
        }
    }
}

const char* const kFbx = R"(; FBX 7.5.0 project file
FBXHeaderExtension:  {
	FBXHeaderVersion: 1003
	FBXVersion: 7500
}
GlobalSettings:  {
	Version: 1000
	Properties70:  {
		P: "UpAxis", "int", "Integer", "", 1
		P: "UpAxisSign", "int", "Integer", "", 1
		P: "FrontAxis", "int", "Integer", "", 2
		P: "FrontAxisSign", "int", "Integer", "", 1
		P: "CoordAxis", "int", "Integer", "", 0
		P: "CoordAxisSign", "int", "Integer", "", 1
		P: "UnitScaleFactor", "double", "Number", "", 1
	}
}
Objects:  {
	Geometry: 10, "Geometry::sheet", "Mesh" {
		Vertices: *12 {
			a: 0,0,0,2,0,0,2,1,0,0,1,0
		}
		PolygonVertexIndex: *4 {
			a: 0,1,2,-4
		}
		GeometryVersion: 124
		LayerElementMaterial: 0 {
			Version: 101
			Name: ""
			MappingInformationType: "AllSame"
			ReferenceInformationType: "IndexToDirect"
			Materials: *1 {
				a: 0
			}
		}
		Layer: 0 {
			Version: 100
			LayerElement:  {
				Type: "LayerElementMaterial"
				TypedIndex: 0
			}
		}
	}
	Model: 20, "Model::door", "Mesh" {
		Version: 232
		Properties70:  {
			P: "Lcl Translation", "Lcl Translation", "", "A",3,0,0
		}
	}
	Material: 30, "Material::oak", "" {
		Version: 102
		ShadingModel: "lambert"
		Properties70:  {
			P: "DiffuseColor", "Color", "", "A",0.5,0.25,0.125
		}
	}
	AnimationStack: 40, "AnimStack::open", "" {
		Properties70:  {
			P: "LocalStop", "KTime", "Time", "",92372316000
		}
	}
	AnimationLayer: 41, "AnimLayer::base", "" {
	}
	AnimationCurveNode: 42, "AnimCurveNode::T", "" {
		Properties70:  {
			P: "d|X", "Number", "", "A",3
			P: "d|Y", "Number", "", "A",0
			P: "d|Z", "Number", "", "A",0
		}
	}
	AnimationCurve: 43, "AnimCurve::", "" {
		Default: 0
		KeyVer: 4008
		KeyTime: *2 {
			a: 0,92372316000
		}
		KeyValueFloat: *2 {
			a: 3,7
		}
		KeyAttrFlags: *1 {
			a: 24836
		}
		KeyAttrDataFloat: *4 {
			a: 0,0,0,0
		}
		KeyAttrRefCount: *1 {
			a: 2
		}
	}
}
Connections:  {
	C: "OO",20,0
	C: "OO",10,20
	C: "OO",30,20
	C: "OO",41,40
	C: "OO",42,41
	C: "OP",42,20, "Lcl Translation"
	C: "OP",43,42, "d|X"
}
)";

TEST(SceneAnimation, AnFbxFileHasItsNodesMaterialsAndAnimations) {
    const Scratch scratch;
    const Result<Model> model = importModel(scratch.file("door.fbx", kFbx));
    ASSERT_TRUE(model) << model.error().message;
    ASSERT_EQ(model->parts.size(), 1U);
    const ModelPart& part = model->parts[0];
    EXPECT_EQ(part.name, "door");
    EXPECT_EQ(part.materialName, "oak");
    EXPECT_TRUE(part.hasMaterial);
    expectNear(part.material.baseColour, vec3(0.5F, 0.25F, 0.125F));
    EXPECT_EQ(part.mesh.indices.size(), 6U);
    EXPECT_EQ(part.mesh.bounds().max, vec3(2, 1, 0));
    ASSERT_EQ(model->clips.size(), 1U);
    EXPECT_EQ(model->clips[0].name, "open");
    EXPECT_NEAR(model->clips[0].seconds, 2.0, 1e-6);
    for (const double time : {0.0, 0.5, 2.0}) {
        const mat4 world = model->worldMatrices(nodesAt(*model, model->clips[0], time))[static_cast<size_t>(part.node)];
        expectNear(vec3(world[3]), vec3(3.0F + 2.0F * static_cast<float>(time), 0, 0));
    }
}

TEST(SceneAnimation, AnObjFileHasTheMaterialsOfItsMtl) {
    const Scratch scratch;
    (void)scratch.file("two.mtl", "newmtl clay\nKd 1 0.5 0.25\nnewmtl slate\nKd 0.125 0.25 0.5\n");
    const std::string triangles = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\n";
    const Result<Model> model =
        importModel(scratch.file("two.obj", "mtllib two.mtl\n" + triangles + "usemtl clay\nf 1 2 3\nusemtl slate\nf 1 2 4\n"));
    ASSERT_TRUE(model) << model.error().message;
    ASSERT_EQ(model->parts.size(), 2U);
    for (const ModelPart& part : model->parts) {
        EXPECT_TRUE(part.hasMaterial);
        expectNear(part.material.baseColour, part.materialName == "clay" ? vec3(1, 0.5F, 0.25F) : vec3(0.125F, 0.25F, 0.5F));
        EXPECT_EQ(part.mesh.bounds().max.z, part.materialName == "clay" ? 0.0F : 1.0F);
    }
    EXPECT_NE(model->parts[0].materialName, model->parts[1].materialName);
    const Result<Model> plain = importWhole(scratch.file("plain.obj", triangles + "f 1 2 3\nf 1 2 4\n"));
    ASSERT_TRUE(plain);
    ASSERT_EQ(plain->parts.size(), 1U);
    EXPECT_FALSE(plain->parts[0].hasMaterial) << "assimp's own material is none of the file's";
    EXPECT_EQ(importWhole(crane(scratch))->parts.at(0).hasMaterial, false) << "nor is the one it gives a glTF part";
}

}  // namespace
}  // namespace rivulet::scene_animation_test
