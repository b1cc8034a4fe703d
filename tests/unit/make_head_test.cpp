// The head that ships is what make_head writes, and it is what animation, tears and skin rely on.
#include <gtest/gtest.h>

#include <assimp/postprocess.h>
#include <assimp/scene.h>
#include <assimp/Importer.hpp>

#include <json/json.h>
#include <stb/stb_image.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <set>
#include <tuple>

#include "engine/core/file.h"
#include "engine/core/math.h"
#include "tests/unit/program_runner.h"

namespace rivulet::testing::make_head_test {
namespace {

namespace fs = std::filesystem;

const fs::path kShipped = fs::path(RIVULET_SOURCE_DIR) / "assets/meshes/head";
const std::set<std::string> kMorphs = {"blinkLeft", "blinkRight",    "browInnerUp", "browDown", "browKnit",   "squintLeft", "squintRight",
                                       "frown",     "mouthOpen",     "mouthPucker", "smile",    "cheekRaise", "mouthPress", "mouthStretch",
                                       "chinRaise", "upperLipRaise", "swallow",     "lookLeft", "lookRight",  "lookUp",     "lookDown"};
const dvec3 kEyes[2] = {{0.0317, 0.0268, 0.0260}, {-0.0317, 0.0268, 0.0260}};  // head.json says the same

class Head : public ::testing::Test {
  protected:
    void SetUp() override {
        scene_ = importer_.ReadFile((kShipped / "head.glb").string(), 0);
        ASSERT_NE(scene_, nullptr) << importer_.GetErrorString();
    }
    const aiMesh& mesh(const std::string& name) const {
        for (unsigned m = 0; m < scene_->mNumMeshes; ++m)
            if (scene_->mMeshes[m]->mName.C_Str() == name) return *scene_->mMeshes[m];
        ADD_FAILURE() << "head.glb has no mesh '" << name << "'";
        return *scene_->mMeshes[0];
    }
    static std::vector<dvec3> positions(const aiVector3D* from, unsigned count) {
        std::vector<dvec3> all;
        for (unsigned i = 0; i < count; ++i) all.emplace_back(from[i].x, from[i].y, from[i].z);
        return all;
    }
    std::vector<dvec3> skinWith(const std::vector<std::string>& morphs, double weight = 1) const {
        return partWith("skin", morphs, weight);
    }
    std::vector<dvec3> partWith(const std::string& part, const std::vector<std::string>& morphs, double weight = 1) const {
        const aiMesh& skin = mesh(part);
        std::vector<dvec3> rest = positions(skin.mVertices, skin.mNumVertices), moved = rest;
        for (unsigned a = 0; a < skin.mNumAnimMeshes; ++a) {
            const aiAnimMesh& morph = *skin.mAnimMeshes[a];
            if (std::find(morphs.begin(), morphs.end(), morph.mName.C_Str()) == morphs.end()) continue;
            for (unsigned i = 0; i < skin.mNumVertices; ++i)
                moved[i] += weight * (dvec3(morph.mVertices[i].x, morph.mVertices[i].y, morph.mVertices[i].z) - rest[i]);
        }
        return moved;
    }
    // How far from an eyeball's centre the skin first lies that way; infinite where it is open.
    class Around {
      public:
        Around(const aiMesh& skin, const std::vector<dvec3>& at, dvec3 centre) {
            for (unsigned f = 0; f < skin.mNumFaces; ++f) {
                const unsigned* v = skin.mFaces[f].mIndices;
                if (glm::distance(at[v[0]], centre) < 0.045 && at[v[0]].z > centre.z - 0.002)
                    near_.push_back({at[v[0]] - centre, at[v[1]] - centre, at[v[2]] - centre});
            }
        }
        double along(dvec3 d) const {
            double least = std::numeric_limits<double>::infinity();
            for (const auto& [a, b, c] : near_) {
                dvec3 e = b - a, f = c - a, p = glm::cross(d, f);
                double det = glm::dot(e, p);
                if (std::abs(det) < 1e-18) continue;
                double u = glm::dot(-a, p) / det;
                dvec3 q = glm::cross(-a, e);
                double v = glm::dot(d, q) / det, t = glm::dot(f, q) / det;
                if (u >= 0 && v >= 0 && u + v <= 1 && t > 0) least = std::min(least, t);
            }
            return least;
        }

      private:
        std::vector<std::tuple<dvec3, dvec3, dvec3>> near_;
    };
    // Eyeball and cornea lie behind the lids, by at least a tenth of a millimetre.
    // The eyes turned by `degrees` about the axis.
    void expectEyesBehindLids(const std::vector<dvec3>& skin, dvec3 axis = dvec3(0, 1, 0), double degrees = 0) const {
        const dmat3 turn(glm::mat3_cast(glm::angleAxis(glm::radians(degrees), axis)));
        for (int k = 0; k < 2; ++k) {
            Around lids(mesh("skin"), skin, kEyes[k]);
            for (const char* part : {"eye", "cornea"}) {
                const aiMesh& eye = mesh(std::string(part) + (k == 0 ? "Left" : "Right"));
                double least = 1;
                for (dvec3 p : positions(eye.mVertices, eye.mNumVertices)) {
                    dvec3 d = turn * (p - kEyes[k]);
                    if (d.z < 0.003) continue;
                    least = std::min(least, lids.along(glm::normalize(d)) - glm::length(d));
                }
                EXPECT_GT(least, 1e-4) << eye.mName.C_Str();
            }
        }
    }
    // The tallest opening between the lids, in metres along their margins.
    static double opening(const Around& lids) {
        const double step = 0.008;
        double tallest = 0;
        for (double out = -0.75; out <= 0.9; out += 0.03) {
            int run = 0;
            for (double up = -0.38; up <= 0.38; up += step) {
                dvec3 d(std::sin(out) * std::cos(up), std::sin(up), std::cos(out) * std::cos(up));
                run = std::isinf(lids.along(d)) ? run + 1 : 0;
                tallest = std::max(tallest, run * step * 0.0137);
            }
        }
        return tallest;
    }
    Assimp::Importer importer_;
    const aiScene* scene_ = nullptr;
};

Outcome makeHead(const std::string& face, const std::string& folder) {
    return runCommand({(fs::path(RIVULET_PROGRAM).parent_path() / "make_head").string(), face, folder});
}

// The same but for what another processor's sines round otherwise.
void expectSamePicture(const std::string& shipped, const std::string& written) {
    int size[2][3];
    std::vector<uint8_t> pixels[2];
    for (int k = 0; k < 2; ++k) {
        uint8_t* data = stbi_load((k == 0 ? shipped : written).c_str(), &size[k][0], &size[k][1], &size[k][2], 4);
        ASSERT_NE(data, nullptr) << (k == 0 ? shipped : written);
        pixels[k].assign(data, data + size_t{4} * static_cast<size_t>(size[k][0] * size[k][1]));
        stbi_image_free(data);
    }
    ASSERT_EQ(pixels[0].size(), pixels[1].size());
    size_t far = 0;
    for (size_t k = 0; k < pixels[0].size(); ++k) far += std::abs(int{pixels[0][k]} - int{pixels[1][k]}) > 8 ? 1 : 0;
    EXPECT_LT(far, pixels[0].size() / 1000) << shipped << " differs from what make_head writes: run it into assets/meshes/head";
}

void expectSameMeshes(const std::string& shipped, const std::string& written) {
    Assimp::Importer one, two;
    const aiScene *a = one.ReadFile(shipped, 0), *b = two.ReadFile(written, 0);
    ASSERT_TRUE(a != nullptr && b != nullptr) << one.GetErrorString() << two.GetErrorString();
    ASSERT_EQ(a->mNumMeshes, b->mNumMeshes);
    for (unsigned m = 0; m < a->mNumMeshes; ++m) {
        const aiMesh &x = *a->mMeshes[m], &y = *b->mMeshes[m];
        ASSERT_EQ(x.mNumVertices, y.mNumVertices);
        ASSERT_EQ(x.mNumFaces, y.mNumFaces);
        ASSERT_EQ(x.mNumAnimMeshes, y.mNumAnimMeshes);
        const auto furthest = [&](const aiVector3D* p, const aiVector3D* q) {
            float most = 0;
            for (unsigned i = 0; i < x.mNumVertices; ++i) most = std::max(most, (p[i] - q[i]).Length());
            return most;
        };
        EXPECT_LT(furthest(x.mVertices, y.mVertices), 2e-6F) << x.mName.C_Str() << ": run make_head into assets/meshes/head";
        for (unsigned k = 0; k < x.mNumAnimMeshes; ++k)
            EXPECT_LT(furthest(x.mAnimMeshes[k]->mVertices, y.mAnimMeshes[k]->mVertices), 4e-6F) << x.mAnimMeshes[k]->mName.C_Str();
    }
}

TEST(MakeHead, WritesTheShippedFilesWithTheSameBytesEachTime) {
    Scratch scratch;
    const std::string face = (kShipped.parent_path() / "canonical_face_model.obj").string();
    for (const char* folder : {"head", "again"}) {
        const Outcome made = makeHead(face, scratch.file(folder));
        ASSERT_EQ(made.code, 0) << made.err;
    }
    uintmax_t bytes = 0;
    for (const auto& entry : fs::directory_iterator(kShipped)) {
        const std::string name = entry.path().filename().string(), written = scratch.file("head") + "/" + name;
        bytes += entry.file_size();
        const Result<std::string> once = readFile(written), twice = readFile(scratch.file("again") + "/" + name);
        ASSERT_TRUE(once) << once.error().message;
        ASSERT_TRUE(twice) << twice.error().message;
        EXPECT_TRUE(*once == *twice) << name << " differs from run to run";
        const std::string kind = entry.path().extension().string();
        if (kind == ".glb")
            expectSameMeshes(entry.path().string(), written);
        else if (kind != ".json")
            expectSamePicture(entry.path().string(), written);
    }
    EXPECT_LT(bytes, 6u << 20);
}

TEST(MakeHead, RefusesAnotherFace) {
    Scratch scratch;
    std::string face = scratch.file("face.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nf 1/1 2/1 3/1\n");
    Outcome made = makeHead(face, scratch.file("head"));
    EXPECT_EQ(made.code, 2);
    EXPECT_NE(made.err.find("canonical face model"), std::string::npos) << made.err;
    EXPECT_FALSE(fs::exists(scratch.file("head")));
}

TEST_F(Head, HasItsPartsAndMorphsByName) {
    for (const char* name : {"skin", "eyeLeft", "eyeRight", "corneaLeft", "corneaRight", "lashesLeft", "lashesRight", "caruncleLeft"})
        mesh(name);
    const aiMesh& skin = mesh("skin");
    EXPECT_GT(skin.mNumFaces, 25000u);
    EXPECT_LT(skin.mNumFaces, 60000u);
    std::set<std::string> names;
    for (unsigned a = 0; a < skin.mNumAnimMeshes; ++a) names.insert(skin.mAnimMeshes[a]->mName.C_Str());
    EXPECT_EQ(names, kMorphs);
    EXPECT_STREQ(scene_->mMaterials[skin.mMaterialIndex]->GetName().C_Str(), "skin");
}

TEST_F(Head, IsItsOwnMirrorImage) {
    const aiMesh& skin = mesh("skin");
    std::vector<dvec3> at = positions(skin.mVertices, skin.mNumVertices);
    std::map<std::tuple<int, int, int>, std::vector<dvec3>> cells;
    auto cell = [](dvec3 p) {
        dvec3 c = glm::floor(p / 1e-3);
        return std::tuple<int, int, int>(c.x, c.y, c.z);
    };
    for (dvec3 p : at) cells[cell(p)].push_back(p);
    size_t alone = 0;
    for (dvec3 p : at) {
        dvec3 twin(-p.x, p.y, p.z);
        double least = 1;
        for (int k = 0; k < 27; ++k)
            for (dvec3 q : cells[cell(twin + dvec3(k % 3 - 1, k / 3 % 3 - 1, k / 9 - 1) * 1e-3)])
                least = std::min(least, glm::distance(q, twin));
        if (least > 1e-4) ++alone;
    }
    EXPECT_EQ(alone, 0u);
}

TEST_F(Head, ChartStaysInTheTileAndTurnsOneWay) {
    const aiMesh& skin = mesh("skin");
    auto uv = [&](unsigned v) { return glm::dvec2(skin.mTextureCoords[0][v].x, skin.mTextureCoords[0][v].y); };
    for (unsigned v = 0; v < skin.mNumVertices; ++v) {
        EXPECT_GE(std::min(uv(v).x, uv(v).y), 0.0);
        EXPECT_LE(std::max(uv(v).x, uv(v).y), 1.0);
    }
    size_t flipped = 0;
    for (unsigned f = 0; f < skin.mNumFaces; ++f) {
        const unsigned* v = skin.mFaces[f].mIndices;
        glm::dvec2 ab = uv(v[1]) - uv(v[0]), ac = uv(v[2]) - uv(v[0]);
        if (ab.x * ac.y - ab.y * ac.x <= 0) ++flipped;
    }
    EXPECT_EQ(flipped, 0u);
}

TEST_F(Head, IsOpenOnlyAtNeckAndBehindTheLids) {
    const aiMesh& skin = mesh("skin");
    std::set<std::pair<unsigned, unsigned>> edges;
    for (unsigned f = 0; f < skin.mNumFaces; ++f)
        for (int k = 0; k < 3; ++k)
            EXPECT_TRUE(edges.insert({skin.mFaces[f].mIndices[k], skin.mFaces[f].mIndices[(k + 1) % 3]}).second) << "an edge is used twice";
    std::map<unsigned, unsigned> next;
    for (auto [a, b] : edges)
        if (!edges.contains({b, a})) EXPECT_TRUE(next.insert({a, b}).second) << "a boundary touches itself";
    std::vector<dvec3> middles;
    while (!next.empty()) {
        dvec3 sum(0);
        int count = 0;
        for (auto at = next.begin(); at != next.end(); ++count) {
            const aiVector3D& p = skin.mVertices[at->first];
            sum += dvec3(p.x, p.y, p.z);
            unsigned to = at->second;
            next.erase(at);
            at = next.find(to);
        }
        middles.push_back(sum / static_cast<double>(count));
    }
    ASSERT_EQ(middles.size(), 3u);
    int behindLids = 0;
    for (dvec3 middle : middles)
        for (dvec3 eye : kEyes) behindLids += glm::distance(middle, eye) < 0.014 ? 1 : 0;
    EXPECT_EQ(behindLids, 2);
    EXPECT_LT(std::min({middles[0].y, middles[1].y, middles[2].y}), -0.17);
}

TEST_F(Head, LidsLieOnTheEyesOpenAndShut) {
    std::vector<dvec3> rest = skinWith({}), shut = skinWith({"blinkLeft", "blinkRight"});
    expectEyesBehindLids(rest);
    expectEyesBehindLids(shut);
    expectEyesBehindLids(skinWith({"squintLeft", "squintRight", "browDown"}));
    for (dvec3 eye : kEyes) {
        double open = opening(Around(mesh("skin"), rest, eye));
        EXPECT_GT(open, 0.008);
        EXPECT_LT(open, 0.012);
        EXPECT_LT(opening(Around(mesh("skin"), shut, eye)), 0.0005);
    }
}

// Where an eyeball's pole has come to, as seen from its centre.
dvec3 poleOf(const std::vector<dvec3>& ball, dvec3 centre) { return glm::normalize(ball[0] - centre); }

TEST_F(Head, EyesTurnTogetherAsRigidBallsAndLidsFollow) {
    const double turns = 25;
    const std::map<std::string, dvec3> looks = {
        {"lookLeft", {0, 1, 0}}, {"lookRight", {0, -1, 0}}, {"lookUp", {-1, 0, 0}}, {"lookDown", {1, 0, 0}}};
    for (const auto& [look, axis] : looks) {
        const glm::dmat3 turn(glm::mat3_cast(glm::angleAxis(glm::radians(turns), axis)));
        for (int k = 0; k < 2; ++k)
            for (const char* part : {"eye", "cornea"}) {
                const std::string name = std::string(part) + (k == 0 ? "Left" : "Right");
                const std::vector<dvec3> rest = partWith(name, {}), moved = partWith(name, {look});
                double most = 0;
                for (size_t v = 0; v < rest.size(); ++v)
                    most = std::max(most, glm::distance(turn * (rest[v] - kEyes[k]), moved[v] - kEyes[k]));
                EXPECT_LT(most, 4e-6) << name << ' ' << look;
            }
        for (const double weight : {0.5, 1.0}) expectEyesBehindLids(skinWith({look}, weight), axis, turns * weight);
    }
    // Not crossed: the lines of sight meet in front of the face, half a metre away or further.
    const dvec3 left = poleOf(partWith("eyeLeft", {}), kEyes[0]), right = poleOf(partWith("eyeRight", {}), kEyes[1]);
    const double meet = (kEyes[0].x - kEyes[1].x) / (right.x / right.z - left.x / left.z);
    EXPECT_GT(meet, 0.5);
    EXPECT_LT(meet, 5.0);
    for (dvec3 eye : kEyes) {
        const double rest = opening(Around(mesh("skin"), skinWith({}), eye)),
                     down = opening(Around(mesh("skin"), skinWith({"lookDown"}), eye)),
                     up = opening(Around(mesh("skin"), skinWith({"lookUp"}), eye));
        EXPECT_LT(down, 0.8 * rest) << "the upper lid goes with a look down";
        EXPECT_GT(down, 0.3 * rest);
        EXPECT_GT(up, rest);
    }
}

// The flesh of an inner corner fills it, and nothing else: it ends well before the cornea and stays behind the edges of the lids.
TEST_F(Head, CaruncleLiesInTheCorner) {
    for (int k = 0; k < 2; ++k) {
        const double side = k == 0 ? 1 : -1;
        const std::vector<dvec3> flesh = partWith(k == 0 ? "caruncleLeft" : "caruncleRight", {}),
                                 white = partWith(k == 0 ? "eyeLeft" : "eyeRight", {});
        double furthest = -1, highest = 0;
        const Around lids(mesh("skin"), skinWith({}), kEyes[k]);
        for (dvec3 p : flesh) {
            const dvec3 d = p - kEyes[k];
            if (glm::length(d) < 0.012) continue;  // below the white
            furthest = std::max(furthest, side * d.x);
            highest = std::max(highest, glm::length(d) - 0.012);
            EXPECT_LT(glm::length(d), lids.along(glm::normalize(d)) + 1e-5) << "in front of a lid";
        }
        EXPECT_LT(furthest, -0.0066) << "the cornea's edge is at 5.9 mm";
        EXPECT_GT(furthest, -0.0095);
        EXPECT_GT(highest, 0.0015) << "a mound";
    }
}

// The points in head.json are on the mesh beside it.
TEST_F(Head, NamesEyesTearsAndMarginsWhereTheyAre) {
    Result<std::string> text = readFile((kShipped / "head.json").string());
    ASSERT_TRUE(text) << text.error().message;
    Json::Value root;
    ASSERT_TRUE(Json::Reader().parse(*text, root));
    auto point = [](const Json::Value& v) { return dvec3(v[0].asDouble(), v[1].asDouble(), v[2].asDouble()); };
    const aiMesh& skin = mesh("skin");
    std::vector<dvec3> at = skinWith({});
    for (int k = 0; k < 2; ++k) {
        const Json::Value& eye = root["eyes"][k == 0 ? "left" : "right"];
        EXPECT_LT(glm::distance(point(eye["eyeball"]["centre"]), kEyes[k]), 1e-6);
        EXPECT_EQ(eye["eyeball"]["radius"].asDouble(), 0.012);
        dvec3 tear = point(eye["tear"]["position"]);
        glm::dvec2 uv(eye["tear"]["uv"][0].asDouble(), eye["tear"]["uv"][1].asDouble());
        double toSkin = 1, toUv = 1, toMargin = 1;
        for (unsigned v = 0; v < skin.mNumVertices; ++v) {
            toSkin = std::min(toSkin, glm::distance(at[v], tear));
            toUv = std::min(toUv, glm::distance(glm::dvec2(skin.mTextureCoords[0][v].x, skin.mTextureCoords[0][v].y), uv));
        }
        dvec3 before = point(eye["inner_corner"]);
        for (const Json::Value& next : eye["lower_lid_margin"]) {
            toMargin = std::min(toMargin, glm::distance(point(next), tear));
            EXPECT_LT(glm::distance(point(next), before), 0.003);  // a line without gaps
            before = point(next);
        }
        EXPECT_LT(toSkin, 0.001);
        EXPECT_LT(toUv, 0.004);
        EXPECT_GT(toMargin, 0.0015);
        EXPECT_LT(toMargin, 0.0035);
        EXPECT_LT(glm::distance(before, point(eye["outer_corner"])), 0.002);
    }
}

}  // namespace
}  // namespace rivulet::testing::make_head_test
