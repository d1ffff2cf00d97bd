#include "prt/scene/checkpoint_file.h"

#include <string>

#include <gtest/gtest.h>

#include "files/folder_lock.h"
#include "files/output_file.h"
#include "tests/own_folder.h"
#include "tests/prt/scenes.h"

namespace relumine::prt {
namespace {

namespace fs = std::filesystem;

std::vector<std::byte> bytes_of_text(const std::string& text) {
    const auto bytes = std::as_bytes(std::span(text));
    return {bytes.begin(), bytes.end()};
}

std::vector<std::vector<std::byte>> all(const std::vector<std::string>& texts) {
    std::vector<std::vector<std::byte>> records;
    for (const std::string& text : texts)
        records.push_back(bytes_of_text(text));
    return records;
}

class CheckpointFileTest : public tests::FolderTest {
protected:
    [[nodiscard]] CheckpointFile open(bool resume, const Fingerprint& fingerprint = {
                                                       {"mesh", "1"}, {"bias", "2"}}) {
        return {output_,
                fingerprint,
                {.resume = resume,
                 .interval = std::chrono::duration<double>(0.0),
                 .on_problem = [this](const auto& text) {
                     problems_.push_back(text);
                 }}};
    }
    void save_two() {
        CheckpointFile checkpoint = open(false);
        EXPECT_TRUE(checkpoint.save("a", bytes_of_text("one"), bytes_of_text("first state")));
        EXPECT_TRUE(checkpoint.save("a", bytes_of_text("two"), bytes_of_text("state")));
        EXPECT_TRUE(checkpoint.save("b", bytes_of_text("x"), {}));
    }
    std::string refusal(const Fingerprint& fingerprint) {
        return tests::message_of([&] { (void)open(true, fingerprint); });
    }
    fs::path output_ = folder_ / "out.prt";
    fs::path checkpoint_ = folder_ / "out.prt.checkpoint";
    std::vector<std::string> problems_;
};

TEST_F(CheckpointFileTest, NothingThereBeforeTheFirstSave) {
    CheckpointFile checkpoint = open(true);
    EXPECT_FALSE(checkpoint.exists());
    EXPECT_TRUE(checkpoint.load("a", true).state.empty());
    EXPECT_EQ(num_files(), 0u);
    EXPECT_TRUE(checkpoint.is_due());
    checkpoint.remove();
    EXPECT_EQ(num_files(), 0u);
}

TEST_F(CheckpointFileTest, GivesBackWhatWasSaved) {
    save_two();
    CheckpointFile checkpoint = open(true);
    EXPECT_TRUE(checkpoint.exists());
    const Checkpoint::Saved a = checkpoint.load("a", true);
    EXPECT_EQ(a.records, all({"one", "two"}));
    EXPECT_EQ(a.state, bytes_of_text("state"));
    EXPECT_EQ(checkpoint.load("b", false).records, all({"x"}));
    EXPECT_TRUE(checkpoint.load("c", true).records.empty());
    checkpoint.remove();
    EXPECT_EQ(num_files(), 0u);
    EXPECT_TRUE(problems_.empty());
}

TEST_F(CheckpointFileTest, ARecordWithoutItsStateDoesNotCount) {
    save_two();
    const std::vector<std::byte> state = files::read(checkpoint_ / "a.state");
    {
        CheckpointFile checkpoint = open(true);
        static_cast<void>(checkpoint.load("a", true));
        EXPECT_TRUE(checkpoint.save("a", bytes_of_text("three"), bytes_of_text("third")));
    }
    // As if killed between the two.
    files::OutputFile file(checkpoint_ / "a.state");
    file.write(state);
    file.commit();
    CheckpointFile checkpoint = open(true);
    EXPECT_EQ(checkpoint.load("a", true).records.size(), 2u);
    EXPECT_TRUE(checkpoint.save("a", bytes_of_text("other"), bytes_of_text("third")));
    EXPECT_EQ(checkpoint.load("a", true).records, all({"one", "two", "other"}));
}

TEST_F(CheckpointFileTest, OtherWorkIsRefusedByTheNameOfWhatDiffers) {
    save_two();
    EXPECT_EQ(refusal({{"mesh", "1"}, {"bias", "2"}}), "");
    EXPECT_NE(refusal({{"mesh", "1"}, {"bias", "3"}}).find("(bias 3), got another's (bias 2)"),
              std::string::npos);
    EXPECT_NE(refusal({{"mesh", "1"}, {"bias", "2"}, {"eye", "4"}}).find("(eye 4)"),
              std::string::npos);
    EXPECT_NE(refusal({{"mesh", "1"}}).find("got one with highlights"), std::string::npos);
    files::save_text(checkpoint_ / "run.json", "{\"mesh\": ");
    EXPECT_NE(refusal({{"mesh", "1"}}).find("run.json: expected a checkpoint, got damaged data"),
              std::string::npos);
}

TEST_F(CheckpointFileTest, AnyFlippedBitIsRefused) {
    save_two();
    for (const char* name : {"a.state", "a.log"}) {
        const std::vector<std::byte> whole = files::read(checkpoint_ / name);
        for (std::size_t i = 0; i < whole.size(); ++i) {
            std::vector<std::byte> bytes = whole;
            bytes[i] ^= std::byte{16};
            files::OutputFile file(checkpoint_ / name);
            file.write(bytes);
            file.commit();
            CheckpointFile checkpoint = open(true);
            EXPECT_THROW(static_cast<void>(checkpoint.load("a", true)), std::runtime_error)
                << name << i;
        }
        files::OutputFile file(checkpoint_ / name);
        file.write(whole);
        file.commit();
    }
}

TEST_F(CheckpointFileTest, WithoutResumeTheFirstSaveBeginsAnew) {
    save_two();
    CheckpointFile checkpoint = open(false, {{"mesh", "other"}});
    EXPECT_FALSE(checkpoint.exists());
    EXPECT_TRUE(checkpoint.load("a", true).state.empty());
    EXPECT_TRUE(fs::exists(checkpoint_ / "b.log")) << "untouched so far";
    EXPECT_TRUE(checkpoint.save("a", bytes_of_text("new"), bytes_of_text("s")));
    EXPECT_FALSE(fs::exists(checkpoint_ / "b.log"));
    EXPECT_EQ(checkpoint.load("a", true).records, all({"new"}));
}

TEST_F(CheckpointFileTest, OneRunAtATime) {
    save_two();
    const auto lock = files::FolderLock::acquire(checkpoint_);
    ASSERT_NE(lock, nullptr);
    EXPECT_NE(refusal({{"mesh", "1"}, {"bias", "2"}}).find("got one in use"), std::string::npos);
    CheckpointFile second = open(false);
    EXPECT_FALSE(second.save("a", bytes_of_text("x"), bytes_of_text("y")));
    EXPECT_EQ(problems_.size(), 1u);
    EXPECT_FALSE(second.is_due());
    second.remove();
    EXPECT_TRUE(fs::exists(checkpoint_ / "a.state"));
}

TEST_F(CheckpointFileTest, AFailedSaveLeavesTheOneBefore) {
    save_two();
    CheckpointFile checkpoint = open(true);
    static_cast<void>(checkpoint.load("a", true));
    fs::create_directories(checkpoint_ / "c.state" / "in the way");
    EXPECT_FALSE(checkpoint.save("c", bytes_of_text("record"), bytes_of_text("state")));
    EXPECT_EQ(problems_.size(), 1u);
    fs::remove_all(checkpoint_ / "c.state");
    EXPECT_TRUE(checkpoint.save("c", bytes_of_text("record"), bytes_of_text("state")));
    EXPECT_EQ(checkpoint.load("c", true).records, all({"record"}));
}

TEST_F(CheckpointFileTest, LeavesFilesOfOthersAlone) {
    save_two();
    files::save_text(checkpoint_ / "notes.txt", "mine");
    CheckpointFile checkpoint = open(true);
    checkpoint.remove();
    EXPECT_TRUE(fs::exists(checkpoint_ / "notes.txt"));
    EXPECT_FALSE(fs::exists(checkpoint_ / "run.json"));
}

TEST(Fingerprint, ChangesWithAllThatTheResultDependsOn) {
    Scene scene;
    scene.mesh = scenes::sphere_and_box_on_floor();
    scene.receivers = vertex_receivers(scene.mesh);
    const Fingerprint plain = fingerprint(scene, {});
    const auto of_settings = [&](const SceneSettings& settings,
                                 std::optional<float> bounce_tolerance = {}) {
        Scene other = scene;
        other.settings = settings;
        return fingerprint(other, bounce_tolerance);
    };
    EXPECT_EQ(of_settings({.source = "other.ply"}), plain);
    EXPECT_NE(of_settings({.glossy_tolerance = 0.1f}), plain);
    EXPECT_NE(of_settings({}, 0.1f), plain);
    EXPECT_NE(of_settings({.two_sided_bounces = true}, 0.1f), of_settings({}, 0.1f));
    EXPECT_NE(of_settings({.tolerance = 0.1f}), plain);
    EXPECT_NE(of_settings({.epsilon = 0.1f}), plain);
    EXPECT_NE(of_settings({.min_level = 1}), plain);
    EXPECT_NE(of_settings({.face_resolution = 1}), plain);
    EXPECT_NE(of_settings({.bias = 1.0f}), plain);
    Scene other = scene;
    other.mesh.positions[3].x += 1e-6f;
    EXPECT_NE(fingerprint(other, {}), plain);
    other = scene;
    std::swap(other.mesh.triangles[0][0], other.mesh.triangles[0][1]);
    EXPECT_NE(fingerprint(other, {}), plain);
    other = scene;
    other.receivers.normals[5].y += 1e-6f;
    EXPECT_NE(fingerprint(other, {}), plain);
}

} // namespace
} // namespace relumine::prt
