#include "fluid/scene/scene_file.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>

#include "engine/core/file.h"
#include "engine/core/json.h"
#include "fluid/sim/sources/block.h"

namespace rivulet::scene_file_test {

namespace {

namespace fs = std::filesystem;

const fs::path kRoot = RIVULET_SOURCE_DIR;

class SceneTest : public ::testing::Test {
  protected:
    SceneTest() { fs::create_directories(folder_ / "scenes"); }
    ~SceneTest() override {
        ::unsetenv("RIVULET_ASSETS");
        fs::remove_all(folder_);
    }
    std::string write(const std::string& name, std::string_view text) const {
        const std::string path = (folder_ / name).string();
        std::ofstream(path) << text;
        return path;
    }
    std::string folder() const { return folder_.string(); }

    // What loadScene says of a scene file of this text.
    std::string errorOf(std::string_view text, const std::vector<std::string>& assignments = {}) const {
        const Result<SceneFile> scene = loadScene(write("x.json", text), assignments);
        if (scene) return "";
        const std::string prefix = folder() + "/";
        const std::string& message = scene.error().message;
        return message.starts_with(prefix) ? message.substr(prefix.size()) : message;
    }

  private:
    fs::path folder_ = fs::temp_directory_path() / ("rivulet_scene_test_" + std::to_string(::getpid()));
};

SceneFile load(const std::string& name) {
    Result<SceneFile> scene = loadScene((kRoot / "assets/scenes" / name).string(), {});
    EXPECT_TRUE(scene) << scene.error().message;
    return scene ? *scene : SceneFile{};
}

double particles(const SceneFile& scene) {
    double count = 0;
    for (const BlockParams& block : scene.fluid.blocks) count += blockCount(block, scene.fluid.spacing);
    return count;
}

// Where a point lands in a 16:9 picture: [-1, 1] on both axes is inside. Written out here so that it checks the renderer's camera, too.
vec2 onPicture(const CameraParams& camera, const vec3& p) {
    const vec3 forward = glm::normalize(camera.target - camera.position);
    const vec3 right = glm::normalize(glm::cross(forward, vec3(0.0F, 1.0F, 0.0F)));
    const vec3 up = glm::cross(right, forward);
    const vec3 d = p - camera.position;
    const float half = std::tan(camera.fieldOfView * kPi / 360.0F) * glm::dot(d, forward);
    return {glm::dot(d, right) / (half * 16.0F / 9.0F), glm::dot(d, up) / half};
}

}  // namespace

TEST_F(SceneTest, TheSmallestSceneIsAnEmptyObject) {
    EXPECT_EQ(errorOf("{}"), "");
    EXPECT_EQ(loadScene(write("x.json", "{}"), {})->folder, folder());
}

TEST_F(SceneTest, EveryShippedSceneLoadsIsDescribedAndFindsItsMeshes) {
    int count = 0;
    for (const fs::directory_entry& entry : fs::directory_iterator(kRoot / "assets/scenes")) {
        const SceneFile scene = load(entry.path().filename().string());
        EXPECT_EQ(scene.name, entry.path().stem().string());
        EXPECT_TRUE(scene.doc.ends_with('.')) << scene.name;
        for (const ColliderParams& collider : scene.colliders)
            EXPECT_TRUE(collider.shape != "mesh" || collider.mesh == "meshes/bunny.obj" /* fetch_bunny.sh brings it */ ||
                        findAsset(collider.mesh, scene.folder))
                << scene.name << " " << collider.mesh;
        ++count;
    }
    EXPECT_GE(count, 4);
}

TEST_F(SceneTest, ShippedScenesHoldAsManyParticlesAsTheirDocSays) {
    EXPECT_NEAR(particles(load("falling_cube.json")), 16384, 0.05 * 16384);
    EXPECT_EQ(particles(load("dam_break.json")), 8192);
    const SceneFile sheet = load("sheet_on_sphere.json");
    ASSERT_EQ(sheet.fluid.blocks.size(), 2U);
    EXPECT_EQ(blockCount(sheet.fluid.blocks[0], sheet.fluid.spacing), 2048);
    EXPECT_EQ(blockCount(sheet.fluid.blocks[1], sheet.fluid.spacing), 1024);
    EXPECT_GT(particles(load("column_over_spot.json")), 20000);
    EXPECT_LT(particles(load("column_over_spot.json")), 30000);
}

TEST_F(SceneTest, CamerasFrameTheWholeBox) {
    for (const fs::directory_entry& entry : fs::directory_iterator(kRoot / "assets/scenes")) {
        const SceneFile scene = load(entry.path().filename().string());
        if (scene.fluid.blocks.empty() && scene.emitters.empty()) continue;  // skins alone: the box is not in the picture
        const BoxParams& box = scene.fluid.box;
        float widest = 0;
        for (int corner = 0; corner < 8; ++corner) {
            const vec3 p((corner & 1) != 0 ? box.max.x : box.min.x, (corner & 2) != 0 ? box.max.y : box.min.y,
                         (corner & 4) != 0 ? box.max.z : box.min.z);
            const vec2 at = onPicture(scene.camera, p);
            widest = std::max({widest, std::abs(at.x), std::abs(at.y)});
        }
        EXPECT_LT(widest, 0.95F) << scene.name;
        EXPECT_GT(widest, 0.8F) << scene.name << " is seen from too far away";
    }
}

TEST_F(SceneTest, EveryAssetHasItsOriginAndLicenceWrittenDown) {
    const std::string sources = *readFile((kRoot / "assets/SOURCES.md").string());
    for (const fs::directory_entry& entry : fs::recursive_directory_iterator(kRoot / "assets")) {
        const std::string path = fs::relative(entry.path(), kRoot / "assets").string();
        if (entry.is_directory() || path == "SOURCES.md" || path.starts_with("scenes/") || path.starts_with("cases/") ||
            path.starts_with("stability/"))
            continue;
        EXPECT_NE(sources.find("`" + path + "`"), std::string::npos) << path << " has no row in assets/SOURCES.md";
    }
}

TEST_F(SceneTest, ContradictingValuesAreRefusedByName) {
    const std::pair<const char*, const char*> refusals[] = {
        {R"({"fluid": {"foam": {"airTo": 0.25}}})", "x.json: fluid.foam.airFrom is 0.3: it must lie below airTo, which is 0.25"},
        {R"({"fluid": {"box": {"min": [0, 2, 0]}}})",
         "x.json: fluid.box.min (0, 2, 0) must lie below fluid.box.max (1, 1, 1) on every axis"},
        {R"({"fluid": {"box": {"max": [1, 1, 0]}}})",
         "x.json: fluid.box.min (0, 0, 0) must lie below fluid.box.max (1, 1, 0) on every axis"},
        {R"({"fluid": {"blocks": [{}, {"min": [0.5, 0, 0], "max": [0.2, 1, 1]}]}})",
         "x.json: fluid.blocks[1].min (0.5, 0, 0) must not lie above its max (0.2, 1, 1)"},
        {R"({"fluid": {"blocks": [{"shape": "mesh", "max": [1, 1, 1]}]}})",
         "x.json: fluid.blocks[0].mesh is empty: name a mesh file, or set another shape"},
        {R"({"fluid": {"blocks": [{"max": [0.5, 1.25, 0.5]}]}})",
         "x.json: fluid.blocks[0] from (0, 0, 0) to (0.5, 1.25, 0.5) reaches outside fluid.box from (0, 0, 0) to (1, 1, 1)"},
        {R"({"fluid": {"blocks": [{"max": [1, 1, 1]}, {"max": [1, 1, 1]}, {"max": [1, 1, 1]}, {"max": [1, 1, 1]}, {"max": [1, 1, 1]},
            {"max": [1, 1, 1]}, {"max": [1, 1, 1]}, {"max": [1, 1, 1]}, {"min": [0.5, 0.5, 0.5], "max": [1, 1, 1]}]}})",
         "x.json: fluid.blocks: more than 8 of them overlap at (0.5, 0.5, 0.5), which makes the water too dense to be simulated: let fewer "
         "overlap"},
        // A staircase: no corner of a block lies in more than one other.
        {R"({"fluid": {"blocks": [{"min": [0, 0.8, 0], "max": [1, 1, 1]}, {"min": [0.1, 0.7, 0], "max": [1, 1, 1]},
            {"min": [0.2, 0.6, 0], "max": [1, 1, 1]}, {"min": [0.3, 0.5, 0], "max": [1, 1, 1]}, {"min": [0.4, 0.4, 0], "max": [1, 1, 1]},
            {"min": [0.5, 0.3, 0], "max": [1, 1, 1]}, {"min": [0.6, 0.2, 0], "max": [1, 1, 1]}, {"min": [0.7, 0.1, 0], "max": [1, 1, 1]},
            {"min": [0.8, 0, 0], "max": [1, 1, 1]}]}})",
         "x.json: fluid.blocks: more than 8 of them overlap at (0.8, 0.8, 0), which makes the water too dense to be simulated: let fewer "
         "overlap"},
        {R"({"colliders": [{"shape": "plane"}, {"shape": "plane", "normal": [0, 0, 0]}]})",
         "x.json: colliders[1].normal is (0, 0, 0): its length must not be 0"},
        {R"({"colliders": [{}]})", "x.json: colliders[0].mesh is empty: name a mesh file, or set another shape"},
        {R"({"bodies": [{}, {"shape": "hull", "position": [0.5, 0.5, 0.5]}]})",
         "x.json: bodies[1].mesh is empty: name a mesh file, or set shape to box or sphere"},
        {R"({"bodies": [{"position": [0.5, 2, 0.5]}]})",
         "x.json: bodies[0].position (0.5, 2, 0.5) must lie in fluid.box from (0, 0, 0) to (1, 1, 1)"},
        {R"({"bodies": [{"parts": [{"mesh": "a.obj"}]}]})", "x.json: bodies[0] is a box: only a hull or mesh can have parts"},
        {R"({"camera": {"position": [0, 1, 2], "target": [0, 1, 2]}})", "x.json: camera.target (0, 1, 2) must differ from camera.position"},
        {R"({"light": {"direction": [0, 0, 0]}})", "x.json: light.direction is (0, 0, 0): its length must not be 0"},
        {R"({"fluid": {"spacingg": 0.1}})", "x.json:1:12: fluid.spacingg is not a parameter; did you mean fluid.spacing?"},
        {R"({"fluid": {"spacing": -1}})", "x.json:1:23: fluid.spacing is -1 m, must be between 1e-05 and 1 m"},
        {R"({"fluid": {"method": "wcsp"}})",
         "x.json:1:22: fluid.method is \"wcsp\", must be one of pbf, dfsph, wcsph, wcsph_thesis; did you mean wcsph?"},
        {R"({"look": {"renderer": "truth"}})",
         "x.json:1:23: look.renderer is \"truth\", must be one of points, screen_space, reference; truth is the earlier name of reference"},
    };
    for (const auto& [text, error] : refusals) EXPECT_EQ(errorOf(text), error) << text;
}

TEST_F(SceneTest, AssignmentsComeAfterTheFileInTheirOrder) {
    const std::string path = write("x.json", R"({"fluid": {"spacing": 0.1}})");
    const std::vector<std::string> assignments = {"fluid.spacing=0.2", "fluid.spacing=0.3", "colliders.0.mesh=cow.obj"};
    const Result<SceneFile> scene = loadScene(path, assignments);
    ASSERT_TRUE(scene) << scene.error().message;
    EXPECT_EQ(scene->fluid.spacing, 0.3F);
    ASSERT_EQ(scene->colliders.size(), 1U);
    EXPECT_EQ(scene->colliders[0].mesh, "cow.obj");
    EXPECT_EQ(errorOf("{}", {"fluid.spacin=1"}), "--set fluid.spacin=1: fluid.spacin is not a parameter; did you mean fluid.spacing?");
    EXPECT_EQ(errorOf("{}", {"fluid.box.min=0,2,0"}),
              "x.json: fluid.box.min (0, 2, 0) must lie below fluid.box.max (1, 1, 1) on every axis");
}

TEST_F(SceneTest, AssetsAreFoundAsGivenThenBesideTheSceneThenInTheVariableThenInTheTree) {
    ::setenv("RIVULET_ASSETS", (":/nowhere:" + folder() + "/mine").c_str(), 1);
    fs::create_directories(fs::path(folder()) / "mine/meshes");
    EXPECT_EQ(*findAsset("meshes/sphere.obj", folder()), (kRoot / "assets/meshes/sphere.obj").string());
    const std::string mine = write("mine/meshes/sphere.obj", "");
    EXPECT_EQ(*findAsset("meshes/sphere.obj", folder()), mine);
    fs::create_directories(fs::path(folder()) / "meshes");
    const std::string beside = write("meshes/sphere.obj", "");
    EXPECT_EQ(*findAsset("meshes/sphere.obj", folder()), beside);
    EXPECT_EQ(*findAsset(mine, folder()), mine);
}

TEST_F(SceneTest, AnAssetThatIsNowhereNamesEveryPlace) {
    ::setenv("RIVULET_ASSETS", "/one:/two", 1);
    const std::string error = findAsset("cow.obj", "/scene").error().message;
    EXPECT_TRUE(error.starts_with("cow.obj does not exist; searched cow.obj, /scene/cow.obj, /one/cow.obj, /two/cow.obj, ")) << error;
    EXPECT_NE(error.find((kRoot / "assets/cow.obj").string()), std::string::npos) << error;
    EXPECT_EQ(findAsset("/nowhere/cow.obj", "").error().message, "/nowhere/cow.obj does not exist");
    EXPECT_EQ(findAsset(folder(), "").error().message, folder() + " is a folder, not a file");
    EXPECT_EQ(loadScene("/nowhere/x.json", {}).error().message, "/nowhere/x.json does not exist");
    EXPECT_FALSE(findAsset("", folder()));
    EXPECT_FALSE(findAsset(std::string(100000, 'x'), folder()));
    EXPECT_FALSE(findAsset(std::string("a\0b", 3), folder()));
}

TEST_F(SceneTest, AListedSceneIsFoundByItsNameAndAMistypedOneIsAnsweredWithTheNearest) {
    ::setenv("RIVULET_ASSETS", folder().c_str(), 1);
    write("scenes/teapot_of_ours.json", R"({"name": "Teapot"})");
    for (const char* typed : {"teapot_of_ours", "teapot_of_ours.json"}) {
        const Result<SceneFile> scene = loadScene(typed, {});
        ASSERT_TRUE(scene) << scene.error().message;
        EXPECT_EQ(scene->name, "Teapot");
        EXPECT_EQ(fs::path(scene->folder).filename(), "scenes");
    }
    const std::string error = loadScene("teapot_of_ors.json", {}).error().message;
    EXPECT_TRUE(error.ends_with("did you mean the scene teapot_of_ours?")) << error;
}

// The order is that of the docs. A scene with a missing mesh names that mesh.
TEST_F(SceneTest, TheListHasTheOrderOfTheDocs) {
    std::ifstream page(kRoot / "docs/scenes/README.md");
    std::vector<std::string> documented, listed;
    for (std::string line; std::getline(page, line);)
        if (line.starts_with("| [")) documented.push_back(line.substr(3, line.find(']') - 3));
    ::setenv("RIVULET_ASSETS", folder().c_str(), 1);
    write("scenes/without.json", R"({"name": "without", "colliders": [{"shape": "mesh", "mesh": "not_there.obj"}]})");
    std::string missing;
    for (const SceneListing& listing : listScenes()) {
        if (fs::path(listing.path).parent_path() == kRoot / "assets/scenes") listed.push_back(fs::path(listing.path).stem().string());
        if (listing.name == "without") missing = listing.missing;
        if (listing.name == "dam_break") EXPECT_EQ(listing.missing, "");
    }
    ASSERT_GT(documented.size(), 20U);
    EXPECT_EQ(listed, documented);
    EXPECT_EQ(missing, "not_there.obj");
}

TEST_F(SceneTest, TheListHasEverySceneOnceAndTheErrorOfABrokenOne) {
    ::setenv("RIVULET_ASSETS", (folder() + ":" + folder() + "/scenes/..").c_str(), 1);
    write("scenes/good.json", R"({"name": "Good", "doc": "All well."})");
    write("scenes/bad.json", "{");
    std::map<std::string, std::string> docs;
    for (const SceneListing& listing : listScenes()) {
        EXPECT_TRUE(docs.emplace(listing.name, listing.doc).second) << listing.name << " twice";
        EXPECT_TRUE(fs::exists(listing.path));
    }
    EXPECT_EQ(docs["Good"], "All well.");
    EXPECT_NE(docs["bad"].find("bad.json:1:2: this is not JSON"), std::string::npos) << docs["bad"];
    EXPECT_TRUE(docs.contains("dam_break"));
}

TEST_F(SceneTest, ParametersPageIsFresh) {
    SceneFile scene;
    const std::string page = describeParams([&](ParamVisitor& v) { scene.visit(v); });
    const Result<std::string> committed = readFile((kRoot / "docs/parameters.md").string());
    EXPECT_TRUE(committed && *committed == page)
        << "docs/parameters.md is stale; refresh it: rivulet list --parameters > docs/parameters.md";
}

TEST_F(SceneTest, EveryDefaultIsWithinItsOwnRange) {
    SceneFile scene, again;
    scene.colliders.resize(1);
    scene.fluid.blocks.resize(1);
    const std::string text = writeJson([&](ParamVisitor& v) { scene.visit(v); });
    const Status read = readJson(text, "defaults", [&](ParamVisitor& v) { again.visit(v); });
    EXPECT_TRUE(read) << read.error().message;
    EXPECT_EQ(writeJson([&](ParamVisitor& v) { again.visit(v); }), text);
}

// The sphere that sheet_on_sphere falls on: a closed surface about the origin, of radius 1.
TEST_F(SceneTest, TheSphereMeshIsAClosedUnitSphere) {
    std::ifstream file(kRoot / "assets/meshes/sphere.obj");
    std::vector<dvec3> positions;
    std::map<std::pair<int, int>, int> edges;
    double volume = 0;
    int triangles = 0;
    for (std::string line; std::getline(file, line);) {
        std::istringstream words(line);
        std::string kind;
        words >> kind;
        if (kind == "v") {
            dvec3& p = positions.emplace_back();
            words >> p.x >> p.y >> p.z;
            EXPECT_NEAR(glm::length(p), 1.0, 1e-6);
        } else if (kind == "f") {
            int corner[3];
            words >> corner[0] >> corner[1] >> corner[2];
            for (int k = 0; k < 3; ++k) ++edges[{corner[k], corner[(k + 1) % 3]}];
            const auto at = [&](int k) { return positions[static_cast<size_t>(corner[k] - 1)]; };
            volume += glm::dot(at(0), glm::cross(at(1), at(2))) / 6.0;
            ++triangles;
        }
    }
    EXPECT_EQ(triangles, 5120);
    EXPECT_NEAR(volume, 4.0 / 3.0 * double{kPi}, 0.01);
    for (const auto& [edge, uses] : edges) {
        EXPECT_EQ(uses, 1);
        EXPECT_TRUE(edges.contains({edge.second, edge.first})) << "an open edge";
    }
}

}  // namespace rivulet::scene_file_test
