// `rivulet flow-check`: its sentences, its exit status, its files, and scenes that use what it finds.
#include <gtest/gtest.h>
#include <json/json.h>

#include <fstream>
#include <sstream>

#include "tests/unit/program_runner.h"
#include "tests/unit/voxel_test_meshes.h"

namespace rivulet::testing::program_flow_check_test {
namespace {

namespace fs = std::filesystem;
const fs::path kMeshes = fs::path(RIVULET_SOURCE_DIR) / "assets/meshes";

Json::Value readJson(const fs::path& path) {
    std::ifstream stream(path);
    Json::Value value;
    EXPECT_TRUE(Json::parseFromStream(Json::CharReaderBuilder(), stream, &value, nullptr)) << path;
    return value;
}

// A square grid of the given UVs.
std::string sheet(const std::function<vec2(vec2)>& uv) {
    constexpr int kEdge = 8;
    std::ostringstream out;
    for (int y = 0; y <= kEdge; ++y)
        for (int x = 0; x <= kEdge; ++x) out << "v " << 0.03 * x << " " << 0.03 * y << " " << 0.002 * x * y << "\n";
    for (int y = 0; y <= kEdge; ++y)
        for (int x = 0; x <= kEdge; ++x) {
            const vec2 t = uv(vec2(x, y) / static_cast<float>(kEdge));
            out << "vt " << t.x << " " << t.y << "\n";
        }
    for (int y = 0; y < kEdge; ++y)
        for (int x = 0; x < kEdge; ++x) {
            const int a = y * (kEdge + 1) + x + 1, b = a + 1, c = b + kEdge + 1, d = a + kEdge + 1;
            out << "f " << a << "/" << a << " " << b << "/" << b << " " << c << "/" << c << "\n";
            out << "f " << a << "/" << a << " " << c << "/" << c << " " << d << "/" << d << "\n";
        }
    return out.str();
}

void expectSays(const Outcome& outcome, int code, std::initializer_list<const char*> sentences) {
    EXPECT_EQ(outcome.code, code) << outcome.err << outcome.out;
    EXPECT_EQ(outcome.err, "");
    for (const char* sentence : sentences) EXPECT_NE(outcome.out.find(sentence), std::string::npos) << sentence << "\n" << outcome.out;
}

TEST(ProgramFlowCheck, TheDefaultHeadIsReady) {
    Scratch scratch;
    const Outcome outcome = runProgram({"flow-check", (kMeshes / "head/head.glb").string(), "--json", "c.json"}, in(scratch));
    expectSays(outcome, 0,
               {"0.339 high", "metres, as a scene needs", "Up is +Y, and the face looks along +Z", "runs over `skin`", "45600 in 1 piece",
                "272 open edges", "21: blinkLeft", "given by", "head.json", "Two eyeballs", "eyeLeft (eye)", "Its tip is at",
                "lowest point is at", "Ready:"});
    const Json::Value json = readJson(scratch.path() / "c.json");
    EXPECT_TRUE(json["ready"].asBool());
    EXPECT_EQ(json["needed"].size(), 0U);
    EXPECT_NEAR(json["eyeDistance"].asDouble(), 0.063, 0.003);
    EXPECT_EQ(json["eyes"]["left"]["tearFrom"].asString(), "file");
    EXPECT_GT(json["texel"].asDouble(), 1.0e-4);
    EXPECT_LT(json["texel"].asDouble(), 1.0e-3);
    EXPECT_EQ(json["morphs"].size(), 21U);
}

// With head.json hidden the eyes are found, and a scene whose lids fill runs with them.
TEST(ProgramFlowCheck, WithoutItsMarksTheHeadCriesFromWhatIsFound) {
    Scratch scratch;
    for (const char* name : {"head.glb", "head_albedo.jpg", "eye_albedo.jpg"}) fs::copy(kMeshes / "head" / name, scratch.path() / name);
    expectSays(runProgram({"flow-check", "head.glb", "--out", "marks.json", "--scene", "tears.json"}, in(scratch)), 0,
               {"Both points where tears begin are found by the program", "Both lids' edges are found by the program", "Ready:"});
    const Json::Value marks = readJson(scratch.path() / "marks.json");
    EXPECT_EQ(marks["eyes"]["left"]["lower_lid_margin"].size(), 25U);
    EXPECT_NEAR(marks["eyes"]["left"]["tear"]["position"][0].asDouble(), 0.0200, 0.001);
    fs::remove(scratch.path() / "marks.json");
    std::ofstream(scratch.path() / "brim.json") << R"({"flow": [{"mesh": "head.glb", "mapSize": 64, "liquid": {"brimStarts": 7.8},
        "sources": [{"kind": "brim", "rate": 300, "drop": 0.02}, {"kind": "corner", "rate": 600, "drop": 8}]}]})";
    const Outcome run =
        runProgram({"run", "brim.json", "--no-render", "--seconds", "1", "--stats", "s.json", "--backend", "cpu"}, in(scratch));
    EXPECT_EQ(run.code, 0) << run.err;
    EXPECT_NE(run.err.find("they were found at its eyeballs"), std::string::npos) << run.err;
    const Json::Value ledger = readJson(scratch.path() / "s.json")["ledger"];
    EXPECT_EQ(ledger["error"].asDouble(), 0);
    EXPECT_NEAR(ledger["emitted"].asDouble(), (2 * 7.8 + 300.0 / 60 + 600.0 / 60) * 1e-9, 9e-9);
    EXPECT_GT(ledger["onSurface"].asDouble(), 1e-8);
}

// A face in centimetres whose eyes are a part of the skin: two things are needed, and with both the check passes.
TEST(ProgramFlowCheck, AFaceInCentimetresIsScaledAndItsMarksAreSaved) {
    Scratch scratch;
    const std::string face = (kMeshes / "canonical_face_model.obj").string();
    expectSays(runProgram({"flow-check", face, "--out", "face.json", "--scene", "tears.json"}, in(scratch)), 1,
               {"17.7 high", "that looks like centimetres", "\"scale\": 0.01", "36 open edges", "None: the face cannot move",
                "estimated from the nose", "Neither eyeballs nor openings", "--out FILE writes them", "Needed:\n1. ", "\n2. "});
    expectSays(runProgram({"flow-check", face, "--scale", "0.01", "--marks", "face.json"}, in(scratch)), 0,
               {"0.177 high", "metres, as a scene needs", "given by face.json", "Ready:"});
    const Json::Value scene = readJson(scratch.path() / "tears.json");
    EXPECT_NEAR(scene["flow"][0]["scale"].asDouble(), 0.01, 1e-6);
    EXPECT_EQ(scene["flow"][0]["marks"].asString(), "face.json");
    const Outcome run =
        runProgram({"run", "tears.json", "--no-render", "--seconds", "0.5", "--stats", "s.json", "--backend", "cpu"}, in(scratch));
    EXPECT_EQ(run.code, 0) << run.err;
    EXPECT_EQ(run.err, "");
    EXPECT_GT(readJson(scratch.path() / "s.json")["ledger"]["emitted"].asDouble(), 1.5e-8);
}

TEST(ProgramFlowCheck, ALyingHeadIsToldItsRotation) {
    Scratch scratch;
    expectSays(runProgram({"flow-check", (kMeshes / "head/head.glb").string(), "--rotation", "90,0,0"}, in(scratch)), 1,
               {"Up is +Z, and the face looks along -Y", "\"rotation\": [0, 0, 0]", "tears run down the face"});
}

TEST(ProgramFlowCheck, OverlappingAndMissingUvsAreReplaced) {
    Scratch scratch;
    scratch.file("good.obj", sheet([](vec2 p) { return 0.1F + 0.8F * p; }));
    scratch.file("folded.obj", sheet([](vec2 p) { return vec2(0.1F + 0.8F * std::abs(p.x - 0.5F), 0.1F + 0.8F * p.y); }));
    scratch.file("bare.obj", [] {
        std::string text = sheet([](vec2 p) { return p; }), bare;
        std::istringstream lines(text);
        for (std::string line; std::getline(lines, line);) {
            if (line.starts_with("vt")) continue;
            for (size_t at; (at = line.find('/')) != std::string::npos;) line.erase(at, line.find_first_of(" \n", at) - at);
            bare += line + "\n";
        }
        return bare;
    }());
    expectSays(runProgram({"flow-check", "good.obj"}, in(scratch)), 1, {"UVs         No faults. The mesh's own are used."});
    expectSays(runProgram({"flow-check", "folded.obj", "--json", "c.json"}, in(scratch)), 1,
               {"Charts overlap: 49.9 %", "belong to another triangle already", "64 triangles are mirrored", "own UVs are used instead"});
    EXPECT_NEAR(readJson(scratch.path() / "c.json")["uvs"]["overlap"].asDouble(), 0.5, 0.01);
    EXPECT_GT(readJson(scratch.path() / "c.json")["uvs"]["newCharts"].asInt(), 0);
    expectSays(runProgram({"flow-check", "bare.obj"}, in(scratch)), 1, {"UVs         None. The program's own UVs are used instead"});
}

TEST(ProgramFlowCheck, WhatIsNoFaceGetsAFormToFillIn) {
    Scratch scratch;
    const std::string sphere = (kMeshes / "sphere.obj").string();
    expectSays(runProgram({"flow-check", sphere, "--out", "form.json"}, in(scratch)), 1,
               {"No eyes were found", "Both lids' edges are not known", "--out FILE writes a form to fill in"});
    EXPECT_EQ(readJson(scratch.path() / "form.json")["eyes"]["right"]["lower_lid_margin"].size(), 3U);
    // Filled with zeros, the form marks no skin.
    expectSays(runProgram({"flow-check", sphere, "--marks", "form.json"}, in(scratch)), 1,
               {"Correct the marks in form.json", "off the skin"});
    const Outcome scene = runProgram({"flow-check", sphere, "--scene", "tears.json"}, in(scratch));
    EXPECT_EQ(scene.code, 2);
    EXPECT_NE(scene.err.find("tears.json was not written: no face was found"), std::string::npos) << scene.err;
    EXPECT_FALSE(fs::exists(scratch.path() / "tears.json"));
}

TEST(ProgramFlowCheck, BadInputIsOneSentence) {
    Scratch scratch;
    scratch.file("empty.obj", "\n");
    std::ofstream(scratch.path() / "nothing.obj").close();
    scratch.file("noise.glb", "this is no model");
    scratch.file("marks.json", R"({"eyes": {"left": {"tear": {"position": [1, 2]}}}})");
    const std::string face = (kMeshes / "canonical_face_model.obj").string();
    expectRefusal(runProgram({"flow-check", "none.obj"}, in(scratch)), 2, "none.obj does not exist");
    expectRefusal(runProgram({"flow-check", "nothing.obj"}, in(scratch)), 2, "nothing.obj");
    expectRefusal(runProgram({"flow-check", "empty.obj"}, in(scratch)), 2, "empty.obj");
    expectRefusal(runProgram({"flow-check", "noise.glb"}, in(scratch)), 2, "noise.glb");
    expectRefusal(runProgram({"flow-check", "."}, in(scratch)), 2, "is a folder");
    expectRefusal(runProgram({"flow-check"}, in(scratch)), 2, "MESH");
    expectRefusal(runProgram({"flow-check", face, "--marks", "marks.json"}, in(scratch)), 2, "marks.json:1:41: three numbers are needed");
    expectRefusal(runProgram({"flow-check", face, "--marks", "no.json"}, in(scratch)), 2, "no.json");
    expectRefusal(runProgram({"flow-check", face, "--map-size", "1000"}, in(scratch)), 2, "power of two");
    expectRefusal(runProgram({"flow-check", face, "--rotation", "1,2"}, in(scratch)), 2, "three angles");
    expectRefusal(runProgram({"flow-check", face, "--scale", "0"}, in(scratch)), 2, "--scale");
    expectRefusal(runProgram({"flow-check", (kMeshes / "head/head.glb").string(), "--part", "skn"}, in(scratch)), 2, "there are skin");
    expectRefusal(runProgram({"flow-check", face, "--out", face}, in(scratch)), 2, "canonical_face_model.obj");
}

}  // namespace
}  // namespace rivulet::testing::program_flow_check_test
