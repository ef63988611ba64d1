// OUT/spec as it is written: the same bytes twice, its manifest, spec.json against its schema.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <sstream>

#include "reports/safe_write.h"
#include "reports/sha256.h"
#include "reports/spec_folder.h"
#include "reports/spec_json.h"
#include "tests/reports/spec_fixture.h"

namespace gradwright {
namespace {

using namespace fixture;
using nlohmann::json;
using testing::HasSubstr;
using testing::StartsWith;

TEST(Sha256, gives_the_published_digests) {  // FIPS 180-4, examples of NIST's cryptographic toolkit
    EXPECT_EQ(sha256(""), "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
    EXPECT_EQ(sha256("abc"), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
    EXPECT_EQ(sha256("abcdbcdecdefdefgefghfghighijhijkijkljklmklmnlmnomnopnopq"),
              "248d6a61d20638b8e5c026930c3e6039a33ce45964ff2167f6ecedd419db06c1");
    EXPECT_EQ(sha256(std::string(1000000, 'a')),
              "cdc76e5c9914fb9281a1c7e284d73e67f1809a48a497200e046d39ccc7112cd0");
}

class SpecFolder : public testing::Test {
  protected:
    void SetUp() override {
        std::string pattern = (std::filesystem::temp_directory_path() / "gradwright_spec_XXXXXX").string();
        ASSERT_NE(mkdtemp(pattern.data()), nullptr);
        folder_ = pattern;
    }
    void TearDown() override { std::filesystem::remove_all(folder_); }
    std::string written(const std::string& name) const { return read_file(folder_ + "/" + name); }
    std::string folder_;
};

TEST_F(SpecFolder, gives_the_same_bytes_twice_and_a_manifest_over_them) {
    const Study study = large();
    FinishedDesign finished = bent();
    finished.verdict = "undecided";
    const HandOver over = hand_over(study, finished);
    const SpecFiles files = write_spec(study, finished, over, StepSchema::ap214, folder_ + "/1");
    write_spec(study, finished, over, StepSchema::ap214, folder_ + "/2");
    EXPECT_EQ(files.step, step_available());
    EXPECT_EQ(written("1/manifest.sha256"), written("2/manifest.sha256"));
    std::istringstream manifest(written("1/manifest.sha256"));
    std::size_t lines = 0;
    for (std::string digest, name; manifest >> digest >> name; ++lines)
        EXPECT_EQ(sha256(written("1/" + name)), digest) << name;
    EXPECT_EQ(lines + 1, files.names.size());
    EXPECT_THAT(written("1/drawing.pdf"), StartsWith("%PDF-1."));
    EXPECT_THAT(written("1/fill_sheet.pdf"), StartsWith("%PDF-1."));
    // two calls within a second agree on today's date too: the fixed one must be there
    for (const char* name : {"1/drawing.pdf", "1/fill_sheet.pdf"})
        EXPECT_NE(written(name).find("20000101000000Z)"), std::string::npos) << name;
    if (files.step) {
        EXPECT_NE(written("1/partition.step").find("'2000-01-01T00:00:00'"), std::string::npos);
    }
    const std::string mark = "NOT VERIFIED: verdict undecided";
    for (const char* name : {"partition.stl", "flat_pattern.dxf", "fill_sheet.html", "spec.json"})
        EXPECT_THAT(written(std::string("1/") + name), HasSubstr(mark)) << name;
    if (files.step) {
        EXPECT_NE(written("1/partition.step").find(mark), std::string::npos);
    }
}

/// Required names, types and constants of a schema; enough of JSON Schema for what docs/schema uses.
void validate(const json& value, const json& schema, const std::string& where) {
    const auto is = [&value](const std::string& type) {
        return type == "object"    ? value.is_object()
               : type == "array"   ? value.is_array()
               : type == "string"  ? value.is_string()
               : type == "boolean" ? value.is_boolean()
               : type == "integer" ? value.is_number_integer()
               : type == "number"  ? value.is_number()
                                   : value.is_null();
    };
    if (schema.contains("type")) {
        bool any = false;
        for (const json& type : schema["type"].is_array() ? schema["type"] : json::array({schema["type"]}))
            any = any || is(type.get<std::string>());
        EXPECT_TRUE(any) << where << " is " << value.dump() << ", not " << schema["type"].dump();
    }
    if (schema.contains("const")) {
        EXPECT_EQ(value, schema["const"]) << where;
    }
    if (schema.contains("enum")) {
        EXPECT_THAT(schema["enum"], testing::Contains(value)) << where;
    }
    if (value.is_object()) {
        for (const json& name : schema.value("required", json::array()))
            EXPECT_TRUE(value.contains(name.get<std::string>())) << where << " lacks " << name;
        // named first: a range-for does not keep the temporary behind items() alive
        const json properties = schema.value("properties", json::object());
        for (const auto& [name, inner] : properties.items())
            if (value.contains(name)) validate(value[name], inner, where + "." + name);
        if (schema.value("additionalProperties", json(true)) == json(false)) {
            for (const auto& [name, ignored] : value.items())
                EXPECT_TRUE(schema["properties"].contains(name))
                    << where << " has " << name << ", which the schema does not know";
        }
    }
    if (value.is_array() && schema.contains("items"))
        for (const json& item : value) validate(item, schema["items"], where + "[]");
}

TEST(SpecJson, is_what_its_schema_says) {
    const json schema =
        json::parse(read_file(std::string(GRADWRIGHT_SOURCE_DIR) + "/docs/schema/spec.schema.json"));
    Study printed = large();
    const FinishedDesign curve = smooth(printed);
    const Study study = large();
    for (const auto& [s, f] : {std::pair{study, straight(study, 20)},
                               {study, bent()},
                               {study, pair_of_curves()},
                               {printed, curve}})
        validate(spec_json(s, f, hand_over(s, f), {"spec.json"}), schema, "spec");
}

}  // namespace
}  // namespace gradwright
