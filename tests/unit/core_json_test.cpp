#include "engine/core/json.h"

#include <gtest/gtest.h>

#include <chrono>
#include <cstring>
#include <locale>
#include <random>

#include "engine/core/sanitized.h"
#include "tests/unit/core_sample.h"

namespace rivulet::core_json_test {

namespace {

// "" when the text was read.
std::string errorOf(std::string_view text) {
    Sample sample;
    const Status read = readJson(text, "x.json", visiting(sample));
    EXPECT_TRUE(read || read.error().fault == Fault::badInput);
    return read ? "" : read.error().message;
}

Sample read(std::string_view text) {
    Sample sample;
    const Status status = readJson(text, "x.json", visiting(sample));
    EXPECT_TRUE(status) << status.error().message << "\n" << text;
    return sample;
}

struct Refusal {
    const char* text;
    const char* error;
};

float anyFloat(std::mt19937& random, float low, float high) { return std::uniform_real_distribution<float>(low, high)(random); }

std::string anyText(std::mt19937& random) {
    static const std::string letters[] = {"a", "Z", " ", "\"", "\\", "\n", "\t", "\x01", "/", "{", "é", "水", ".", "0"};
    std::string text;
    for (int i = std::uniform_int_distribution<int>(0, 12)(random); i > 0; --i) text += letters[random() % std::size(letters)];
    return text;
}

Sample anySample(std::mt19937& random) {
    Sample s;
    s.name = anyText(random);
    do {  // every finite float within the range of a Param that sets none
        const uint32_t bits = static_cast<uint32_t>(random());
        std::memcpy(&s.free, &bits, sizeof bits);
    } while (!(std::abs(s.free) <= 1e30F));
    s.fluid.spacing = anyFloat(random, 0.0006F, 0.9F);
    s.fluid.substeps = 1 + static_cast<int>(random() % 64);
    s.fluid.walls = random() % 2 == 0;
    if (random() % 2 == 0) s.fluid.method = "wcsph_thesis";
    s.fluid.gravity = vec3(anyFloat(random, -999, 999), anyFloat(random, -1e-6F, 1e-6F), anyFloat(random, -1e-38F, 1e-38F));
    s.colliders.resize(random() % 4);
    for (SampleItem& item : s.colliders) {
        item.mesh = anyText(random);
        item.parts.resize(random() % 3);
        for (SamplePart& part : item.parts) part.count = static_cast<int>(random() % 10);
        if (random() % 2 == 0) item.tint = vec3(anyFloat(random, 0, 1), anyFloat(random, 0, 1), anyFloat(random, 0, 1));
    }
    return s;
}

// A locale with a decimal comma, which a host may have set for the whole process.
struct CommaNumbers : std::numpunct<char> {
    char do_decimal_point() const override { return ','; }
    char do_thousands_sep() const override { return '.'; }
    std::string do_grouping() const override { return "\3"; }
};

class GlobalLocale {
  public:
    explicit GlobalLocale(const std::locale& locale) : before_(std::locale::global(locale)) {}
    ~GlobalLocale() { std::locale::global(before_); }
    GlobalLocale(const GlobalLocale&) = delete;
    GlobalLocale& operator=(const GlobalLocale&) = delete;

  private:
    std::locale before_;
};

}  // namespace

TEST(Json, EveryKeyIsOptional) { EXPECT_EQ(read("{}"), Sample{}); }

TEST(Json, ReadsEveryKindOfValue) {
    const Sample s = read(R"({"name": "a \"b\" \u00e9\n", "free": -1.5e3, "fluid": {"spacing": 0.25, "substeps": 2e1, "walls": false,
        "method": "wcsph_thesis", "gravity": [1, -2.5, 3e-1]}, "colliders": [{}, {"mesh": "cow.obj", "tint": [0, 0.5, 1]}]})");
    EXPECT_EQ(s.name, "a \"b\" \u00e9\n");
    EXPECT_EQ(s.free, -1500.0F);
    EXPECT_EQ(s.fluid.spacing, 0.25F);
    EXPECT_EQ(s.fluid.substeps, 20);
    EXPECT_FALSE(s.fluid.walls);
    EXPECT_EQ(s.fluid.method, "wcsph_thesis");
    EXPECT_EQ(s.fluid.gravity, vec3(1.0F, -2.5F, 0.3F));
    ASSERT_EQ(s.colliders.size(), 2U);
    EXPECT_EQ(s.colliders[0], SampleItem{});
    EXPECT_EQ(s.colliders[1].mesh, "cow.obj");
    EXPECT_EQ(s.colliders[1].tint, vec3(0.0F, 0.5F, 1.0F));
}

TEST(Json, RangesAreInclusiveAndMeanTheDecimalThatWasTyped) {
    EXPECT_EQ(read(R"({"fluid": {"spacing": 0.0005}})").fluid.spacing, 0.0005F);
    EXPECT_EQ(read(R"({"fluid": {"spacing": 1}})").fluid.spacing, 1.0F);
    EXPECT_EQ(read(R"({"colliders": [{"size": 0.001}]})").colliders[0].size, 0.001F);
}

TEST(Json, NumbersTooSmallForAFloatRoundToOne) { EXPECT_EQ(read(R"({"free": 1e-60})").free, 0.0F); }

TEST(Json, AByteOrderMarkAndWindowsLineEndsAreRead) {
    EXPECT_EQ(read("\xEF\xBB\xBF{\r\n\"free\": 2\r\n}\r\n").free, 2.0F);
    EXPECT_EQ(errorOf("\xEF\xBB\xBF{\r\n\"freee\": 2\r\n}"), "x.json:2:1: freee is not a parameter; did you mean free?");
}

TEST(Json, RefusesValuesWithPlacePathAndRemedy) {
    const Refusal refusals[] = {
        {"{\n  \"fluid\": {\n    \"spacingg\": 0.1\n  }\n}", "x.json:3:5: fluid.spacingg is not a parameter; did you mean fluid.spacing?"},
        {R"({"spacing": 0.1})", "x.json:1:2: spacing is not a parameter; did you mean fluid.spacing?"},
        {R"({"mesh": "cow.obj"})", "x.json:1:2: mesh is not a parameter; did you mean colliders[].mesh?"},
        {R"({"zzzzzz": 1})", "x.json:1:2: zzzzzz is not a parameter; known here: name, free, fluid, colliders"},
        {R"({"a\"b\\": 1})", R"(x.json:1:2: a"b\ is not a parameter; known here: name, free, fluid, colliders)"},
        {R"({"zz": 1, "aa": 2})", "x.json:1:2: zz is not a parameter; known here: name, free, fluid, colliders"},
        {R"({"": 1})", "x.json:1:2:  is not a parameter; known here: name, free, fluid, colliders"},
        {R"({"fluid": {"spacing": -1}})", "x.json:1:23: fluid.spacing is -1 m, must be between 0.0005 and 1 m"},
        {R"({"fluid": {"spacing": 1e400}})", "x.json:1:23: fluid.spacing is 1e400, must be a number between 0.0005 and 1 m"},
        {R"({"fluid": {"spacing": "0.1"}})", "x.json:1:23: fluid.spacing is \"0.1\", must be a number between 0.0005 and 1 m"},
        {R"({"fluid": {"spacing": null}})", "x.json:1:23: fluid.spacing is null, must be a number between 0.0005 and 1 m"},
        {R"({"fluid": {"substeps": 2.5}})", "x.json:1:24: fluid.substeps is 2.5, must be a whole number between 1 and 64"},
        {R"({"fluid": {"substeps": 1e20}})", "x.json:1:24: fluid.substeps is 1e20, must be between 1 and 64"},
        {R"({"fluid": {"walls": 1}})", "x.json:1:21: fluid.walls is 1, must be true or false"},
        {R"({"fluid": {"method": 3}})", "x.json:1:22: fluid.method is 3, must be text in double quotes"},
        {R"({"fluid": {"method": "wcspf"}})",
         "x.json:1:22: fluid.method is \"wcspf\", must be one of wcsph, wcsph_thesis; did you mean wcsph?"},
        {R"({"name": ["a"]})", "x.json:1:10: name is [\"a\"], must be text in double quotes"},
        {R"({"fluid": {"gravity": [0, 1]}})",
         "x.json:1:23: fluid.gravity is [0, 1], must be three numbers [x, y, z], each between -1000 and 1000 m/s^2"},
        {R"({"fluid": {"gravity": [0, 1, 2, 3]}})",
         "x.json:1:23: fluid.gravity is [0, 1, 2, 3], must be three numbers [x, y, z], each between -1000 and 1000 m/s^2"},
        {R"({"fluid": {"gravity": [0, "1", 2]}})",
         "x.json:1:23: fluid.gravity is [0, \"1\", 2], must be three numbers [x, y, z], each between -1000 and 1000 m/s^2"},
        {R"({"fluid": {"gravity": [0, 9999, 0]}})",
         "x.json:1:23: fluid.gravity is [0, 9999, 0] m/s^2, must be between -1000 and 1000 m/s^2 in each component"},
        {R"({"free": 1e39})", "x.json:1:10: free is 1e39, must be between -1e+30 and 1e+30"},
        {R"({"fluid": 3})", "x.json:1:11: fluid is 3, must be an object {...}"},
        {R"({"colliders": {}})", "x.json:1:15: colliders is {}, must be a list [...]"},
        {R"({"colliders": [{}, 5]})", "x.json:1:20: colliders[1] is 5, must be an object {...}"},
        {R"({"colliders": [{}, {}, {"mash": "cow.obj"}]})",
         "x.json:1:25: colliders[2].mash is not a parameter; did you mean colliders[2].mesh?"},
        {R"({"colliders": [{"tint": [0, 0, 2]}]})",
         "x.json:1:25: colliders[0].tint is [0, 0, 2], must be between 0 and 1 in each component"},
        {R"({"colliders": [{"parts": [{}, {"count": -1}]}]})", "x.json:1:41: colliders[0].parts[1].count is -1, must be between 0 and 9"},
        {R"({"colliders": [{"parts": [{"mash": 1}]}]})", "x.json:1:28: colliders[0].parts[0].mash is not a parameter; known here: count"},
        {"[1, 2]", "x.json:1:1: the file's outermost value is [1, 2], must be an object {...}"},
    };
    for (const Refusal& r : refusals) EXPECT_EQ(errorOf(r.text), r.error) << r.text;
}

TEST(Json, RefusesInvalidJson) {
    const Refusal refusals[] = {
        {"", "x.json:1:1: the file is empty; it must contain at least {}"},
        {" \n\t ", "x.json:1:1: the file is empty; it must contain at least {}"},
        {"{\n\"free\": NaN}", "x.json:2:9: this is not JSON: NaN is not a value in JSON; strings and keys must be in double quotes"},
        {R"({"free": -Infinity})", "x.json:1:10: this is not JSON: -Infinity is not a number in JSON"},
        {"{free: 1}", "x.json:1:2: this is not JSON: free is not a value in JSON; strings and keys must be in double quotes"},
        {R"({"free": True})", "x.json:1:10: this is not JSON: True is not a value in JSON; strings and keys must be in double quotes"},
        {"{'free': 1}", "x.json:1:2: this is not JSON: unexpected '''"},
        {R"({"free": 01})", "x.json:1:10: this is not JSON: 01 is not a number in JSON"},
        {R"({"free": 1.})", "x.json:1:10: this is not JSON: 1. is not a number in JSON"},
        {R"({"free": .5})", "x.json:1:10: this is not JSON: unexpected '.'"},
        {R"({"free": -})", "x.json:1:10: this is not JSON: - is not a number in JSON"},
        {R"({"free": +1})", "x.json:1:10: this is not JSON: unexpected '+'"},
        {R"({"free": 1e})", "x.json:1:10: this is not JSON: 1e is not a number in JSON"},
        {R"({"free": 0x10})", "x.json:1:10: this is not JSON: 0x10 is not a number in JSON"},
        {R"({"free": 1-2})", "x.json:1:10: this is not JSON: 1-2 is not a number in JSON"},
        {"// scene\n{}", "x.json:1:1: this is not JSON: comments are not allowed in JSON"},
        {"{\"free\": 1 /* one */}", "x.json:1:12: this is not JSON: comments are not allowed in JSON"},
        {"{\"name\": \"a\nb\"}", "x.json:1:10: this is not JSON: the string that starts here has no closing quote on its line"},
        {"{\"name\": \"a", "x.json:1:10: this is not JSON: the string that starts here has no closing quote on its line"},
        {R"({"free": 1, "free": 2})", "x.json:1:13: this is not JSON: Duplicate key: 'free'"},
        {R"({"free": 1,})", "x.json:1:12: this is not JSON: Missing '}' or object member name"},
        {R"({"free": 1 "name": 2})", "x.json:1:12: this is not JSON: Missing ',' or '}' in object declaration"},
        {R"({"free" 1})", "x.json:1:9: this is not JSON: Missing ':' after object member name"},
        {R"({"free": 1)", "x.json:1:11: this is not JSON: Missing ',' or '}' in object declaration"},
        {"{}\n{}", "x.json:2:1: this is not JSON: Extra non-whitespace after JSON value"},
        {"{} x", "x.json:1:4: this is not JSON: x is not a value in JSON; strings and keys must be in double quotes"},
        {R"({"name": "\x"})", "x.json:1:10: this is not JSON: Bad escape sequence in string"},
    };
    for (const Refusal& r : refusals) EXPECT_EQ(errorOf(r.text), r.error) << r.text;
    EXPECT_EQ(errorOf(std::string_view("{}\0{", 4)), "x.json:1:3: this is not JSON: unexpected byte 0x00");
    EXPECT_EQ(errorOf("{\"free\": 1\xff}"), "x.json:1:10: this is not JSON: 1\xff is not a number in JSON");
}

TEST(Json, HostileTextIsRefusedQuickly) {
    // Builds with a sanitizer are several times slower: they read a quarter.
    const size_t whole = size_t{kSanitized ? 15 : 60} << 20U, part = size_t{kSanitized ? 1 : 4} << 20U;
    std::string list = R"({"free": [)";
    for (int i = 0; i < 1000000; ++i) list += "0,";
    const auto start = std::chrono::steady_clock::now();
    EXPECT_EQ(errorOf(std::string(whole, '[')), "x.json:1:65: this is not JSON: nesting is deeper than 64 levels");
    EXPECT_EQ(errorOf(std::string(part, ']')), "x.json:1:1: this is not JSON: Syntax error: value, object or array expected");
    EXPECT_EQ(errorOf(list), "x.json:1:524300: this is not JSON: there are more than 262144 values");
    EXPECT_EQ(errorOf(std::string(part, '1')),
              "x.json:1:1: the file's outermost value is " + std::string(60, '1') + "..., must be an object {...}");
    EXPECT_EQ(errorOf(R"({"name": ")" + std::string(part, 'x') + "\"}"), "");
    EXPECT_EQ(errorOf("{\"" + std::string(part, 'k') + "\": 1}"),
              "x.json:1:2: " + std::string(60, 'k') + "... is not a parameter; known here: name, free, fluid, colliders");
    EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(10));
}

TEST(Json, TextCutOffAnywhereIsRefusedAndNothingThrows) {
    Sample s;
    s.colliders.resize(2);
    const std::string whole = writeJson(visiting(s));
    for (size_t length = 0; length + 2 < whole.size(); ++length) EXPECT_NE(errorOf(whole.substr(0, length)), "") << length;
}

TEST(Json, AnyByteMayBeWrongAndNothingThrows) {
    std::mt19937 random(7);
    Sample s;
    s.colliders.resize(2);
    const std::string whole = writeJson(visiting(s));
    for (int i = 0; i < 3000; ++i) {
        std::string text = whole;
        for (int k = 0; k < 3; ++k) text[random() % text.size()] = static_cast<char>(random());
        const std::string error = errorOf(text);
        EXPECT_EQ(error.find('\n'), std::string::npos) << "an error is one line";
    }
}

TEST(Json, WrittenValuesReadBackEqual) {
    std::mt19937 random(1);
    VisitFn defaults = [](ParamVisitor& v) { Sample().visit(v); };
    for (int i = 0; i < 500; ++i) {
        Sample s = anySample(random);
        EXPECT_EQ(read(writeJson(visiting(s))), s) << writeJson(visiting(s));
        EXPECT_EQ(read(writeJson(visiting(s), &defaults)), s) << writeJson(visiting(s), &defaults);
    }
}

TEST(Json, WritesShortNumbersAndIndents) {
    Sample s;
    s.free = 0.1F;
    s.colliders.resize(1);
    s.colliders[0].mesh = "a\"\x01";
    s.colliders[0].parts = {{2}};
    EXPECT_EQ(writeJson(visiting(s)), R"({
    "name": "unnamed",
    "free": 0.1,
    "fluid": {
        "spacing": 0.02,
        "substeps": 4,
        "walls": true,
        "method": "wcsph",
        "gravity": [0, -9.81, 0]
    },
    "colliders": [
        {
            "size": 0.5,
            "mesh": "a\"\u0001",
            "tint": [1, 0.5, 0.25],
            "parts": [
                {
                    "count": 2
                }
            ]
        }
    ]
}
)");
}

TEST(Json, WritesOnlyValuesThatDiffer) {
    VisitFn defaults = [](ParamVisitor& v) { Sample().visit(v); };
    Sample s;
    EXPECT_EQ(writeJson(visiting(s), &defaults), "{}\n");
    s.fluid.substeps = 5;
    s.colliders.resize(2);
    s.colliders[1].size = 2;
    EXPECT_EQ(writeJson(visiting(s), &defaults), R"({
    "fluid": {
        "substeps": 5
    },
    "colliders": [
        {},
        {
            "size": 2
        }
    ]
}
)");
    Sample oneCollider;
    oneCollider.colliders.resize(1);
    VisitFn other = visiting(oneCollider);
    Sample none;
    EXPECT_EQ(writeJson(visiting(none), &other), "{\n    \"colliders\": []\n}\n");
}

TEST(Json, ANumberThatJsonCannotHoldIsWrittenAsNullAndRefusedByName) {
    Sample s;
    s.fluid.spacing = std::numeric_limits<float>::quiet_NaN();
    EXPECT_EQ(errorOf(writeJson(visiting(s))), "x.json:5:20: fluid.spacing is null, must be a number between 0.0005 and 1 m");
}

TEST(Json, NoLocaleChangesNumbers) {
    const GlobalLocale german(std::locale(std::locale::classic(), new CommaNumbers));
    Sample s;
    s.free = 1234567.5F;
    s.fluid.spacing = 0.125F;
    const std::string text = writeJson(visiting(s));
    EXPECT_NE(text.find("\"free\": 1234567.5,"), std::string::npos) << text;
    EXPECT_EQ(read(text), s);
    EXPECT_EQ(errorOf(R"({"fluid": {"spacing": 1.5}})"), "x.json:1:23: fluid.spacing is 1.5 m, must be between 0.0005 and 1 m");
}

}  // namespace rivulet::core_json_test
