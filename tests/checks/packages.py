#!/usr/bin/env python3
"""packages.py ROOT: third_party/vcpkg/vcpkg.json keeps the rules of vcpkg's published schema (vcpkg.schema.json of microsoft/vcpkg-tool), and
third_party/conan/conanfile.py those of Conan's reference of recipes. Both name the version of CMakeLists.txt and the libraries that
third_party/dependencies.cmake looks for. Neither vcpkg nor Conan is run: they are no packages of Debian."""
import importlib.util
import json
import pathlib
import re
import sys
import types

root = pathlib.Path(sys.argv[1]).resolve()
faults = []


def check(holds, sentence):
    if not holds:
        faults.append(sentence)


version = re.search(r"project\(rivulet VERSION ([0-9.]+)", (root / "CMakeLists.txt").read_text())[1]
# What the library looks for: everything before the program's dependencies. Names of vcpkg and of Conan.
looked_for = (root / "third_party/dependencies.cmake").read_text().split("if(RIVULET_PROGRAM)")[0]
looked_for = re.sub(r"^ *#.*", "", looked_for, flags=re.M)
NAMES = {"fmt": ("fmt", "fmt"), "TBB": ("tbb", "onetbb"), "glm": ("glm", "glm"), "jsoncpp": ("jsoncpp", "jsoncpp"), "libzstd": ("zstd", "zstd"),
         "libxxhash": ("xxhash", "xxhash"), "eigen3": ("eigen3", "eigen"), "stb": ("stb", "stb"), "OpenCL": ("opencl", "opencl-icd-loader"),
         "PkgConfig": ("pkgconf", "pkgconf")}
packages = set(re.findall(r"rivulet_find\(\S+ (\w+)", looked_for)) | set(re.findall(r"find_package\((\w+)", looked_for)) - {"Threads"}
for words in re.findall(r"rivulet_find_modules\(([^)$]*)\)", looked_for):
    packages |= set(words.split())
packages |= {path.split("/")[0] for path in re.findall(r"find_path\(\w+ (\w+/[\w.]+)", looked_for)}
packages -= {"Threads"}
check(packages == set(NAMES), f"third_party/dependencies.cmake looks for {sorted(packages)}; this test knows {sorted(NAMES)}")

# vcpkg.json
manifest = json.loads((root / "third_party/vcpkg/vcpkg.json").read_text())
IDENTIFIER = r"[a-z0-9]+(-[a-z0-9]+)*"
VERSIONS = {"version", "version-semver", "version-date", "version-string"}
TOP = VERSIONS | {"name", "port-version", "maintainers", "summary", "description", "homepage", "documentation", "license", "builtin-baseline",
                  "dependencies", "overrides", "features", "default-features", "supports", "vcpkg-configuration"}
DEPENDENCY = {"name": str, "features": list, "host": bool, "default-features": bool, "platform": str, "version>=": str}


def keys(value, allowed, place):
    unknown = {key for key in value if not key.startswith("$")} - set(allowed)
    check(not unknown, f"{place} has keys that vcpkg does not know: {sorted(unknown)}")


def dependencies(values, place):
    check(isinstance(values, list), f"{place}.dependencies must be a list")
    for value in values:
        if isinstance(value, dict):
            keys(value, DEPENDENCY, f"{place}.dependencies")
            check("name" in value, f"{place}.dependencies has an object without a name")
            for key, kind in DEPENDENCY.items():
                check(key not in value or isinstance(value[key], kind), f"{place}.dependencies: {key} must be {kind.__name__}")
        name = value.get("name", "") if isinstance(value, dict) else value
        check(isinstance(name, str) and re.fullmatch(IDENTIFIER, name), f"{place}.dependencies: {name!r} is no name of a port")
        yield name


keys(manifest, TOP, "vcpkg.json")
check(re.fullmatch(IDENTIFIER, manifest["name"]), "vcpkg.json: name must be lower case letters, digits and hyphens")
check(len(VERSIONS & set(manifest)) == 1, f"vcpkg.json must have exactly one of {sorted(VERSIONS)}")
check(re.fullmatch(r"\d+\.\d+\.\d+", manifest["version-semver"]), "vcpkg.json: version-semver must be three numbers")
check(manifest["version-semver"] == version, f"vcpkg.json has version {manifest['version-semver']}, CMakeLists.txt {version}")
for key in ("description", "license", "supports"):
    check(isinstance(manifest[key], str) and manifest[key], f"vcpkg.json: {key} must be a text")
named = set(dependencies(manifest["dependencies"], "vcpkg.json"))
for name, feature in manifest["features"].items():
    check(re.fullmatch(IDENTIFIER, name), f"vcpkg.json: {name!r} is no name of a feature")
    keys(feature, {"description", "dependencies", "supports"}, f"vcpkg.json, feature {name}")
    check(bool(feature.get("description")), f"vcpkg.json: feature {name} must have a description")
    named |= set(dependencies(feature.get("dependencies", []), f"vcpkg.json, feature {name}"))
expected = {vcpkg for vcpkg, _ in NAMES.values()}
check(named == expected, f"vcpkg.json names {sorted(named)}; the build looks for {sorted(expected)}")

# conanfile.py, loaded with stand-ins for Conan's modules: they only record.
class ConanFile:
    def __init__(self):
        self.recipe_folder = str(root / "third_party/conan")
        self.required = {}
        self.options = types.SimpleNamespace(**{name: values[0] for name, values in self.options.items()})

    def requires(self, reference, **_):
        version = r"[A-Za-z0-9_+.-]+|\[[<>]=?[0-9.]+( <[0-9.]+)?\]"
        check(re.fullmatch(rf"[a-z0-9_+.-]{{2,101}}/({version})", reference), f"conanfile.py: {reference!r} is not NAME/VERSION or NAME/[RANGE]")
        self.required[reference.split("/")[0]] = reference

    def tool_requires(self, reference):
        self.required[reference.split("/")[0]] = reference


PARTS = {"conan": ["ConanFile"], "conan.tools": [], "conan.tools.build": ["check_min_cppstd"], "conan.tools.files": ["copy"],
         "conan.tools.cmake": ["CMake", "CMakeDeps", "CMakeToolchain", "cmake_layout"], "conan.tools.gnu": ["PkgConfigDeps"]}
for module, members in PARTS.items():
    sys.modules[module] = types.ModuleType(module)
    for member in members:
        setattr(sys.modules[module], member, ConanFile if member == "ConanFile" else lambda *_, **__: None)
sys.dont_write_bytecode = True
spec = importlib.util.spec_from_file_location("conanfile", root / "third_party/conan/conanfile.py")
conanfile = importlib.util.module_from_spec(spec)
spec.loader.exec_module(conanfile)
recipes = [value for value in vars(conanfile).values() if isinstance(value, type) and issubclass(value, ConanFile) and value is not ConanFile]
check(len(recipes) == 1, "conanfile.py must define exactly one ConanFile")
recipe = recipes[0]()
check(re.fullmatch(r"[a-z0-9_][a-z0-9_+.-]{1,100}", recipe.name), "conanfile.py: name must be 2 to 101 lower case letters, digits and _ + . -")
check(recipe.license == manifest["license"], "conanfile.py and vcpkg.json name different licences")
check(set(recipe.settings) == {"os", "arch", "compiler", "build_type"}, "conanfile.py: settings must be os, arch, compiler, build_type")
check(recipe.package_type in ("static-library", "shared-library", "library", "header-library", "application"), "conanfile.py: package_type")
check(set(recipe.default_options) == set(recipes[0].options), "conanfile.py: each option must have a default")
for method in ("set_version", "layout", "requirements", "generate", "build", "package", "package_info", "export_sources"):
    check(callable(getattr(recipe, method, None)), f"conanfile.py has no method {method}")
recipe.set_version()
check(recipe.version == version, f"conanfile.py finds version {recipe.version}, CMakeLists.txt has {version}")
recipe.requirements()
recipe.build_requirements()
expected = {conan for _, conan in NAMES.values()} | {"cmake"}
check(set(recipe.required) == expected, f"conanfile.py requires {sorted(recipe.required)}; the build looks for {sorted(expected)}")

if faults:
    sys.exit("\n".join(faults))
print("vcpkg.json and conanfile.py: in order")
