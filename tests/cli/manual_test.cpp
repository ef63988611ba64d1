// The man page and the completion scripts: complete, sound to the tools that read them, and in a real bash
// the right words.
#include <gmock/gmock.h>

#include "called_program.h"

namespace {

namespace fs = std::filesystem;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

class Manual : public CalledProgram {
  protected:
    /// Verbs of the help text: two blanks, the name, blanks, a description.
    std::vector<std::string> verbs() const {
        std::istringstream lines(run({"help"}).out);
        std::vector<std::string> names;
        bool inside = false;
        for (std::string line; std::getline(lines, line);) {
            if (line.starts_with("Subcommands:")) {
                inside = true;
            } else if (inside && line.size() > 2 && line.starts_with("  ") && line[2] != ' ') {
                names.push_back(line.substr(2, line.find(' ', 2) - 2));
            } else if (inside && line.empty()) {
                break;
            }
        }
        return names;
    }
    /// Long options in the help of a verb.
    std::vector<std::string> options(const std::string& verb) const {
        const std::string help = run({"help", verb}).out;
        std::vector<std::string> names;
        for (auto at = help.find("--"); at != std::string::npos; at = help.find("--", at + 2)) {
            const auto end = help.find_first_not_of("abcdefghijklmnopqrstuvwxyz0123456789-", at);
            const auto line = help.rfind('\n', at);
            if (at - line < 12) names.push_back(help.substr(at, end - at));  // in the column of names
        }
        return names;
    }
    static std::string roff(std::string text) {
        for (auto at = text.find('-'); at != std::string::npos; at = text.find('-', at + 2))
            text.insert(at, "\\");
        return text;
    }
    /// COMPREPLY after the words, the last of them under the cursor, as bash's own `complete -F` is called.
    std::vector<std::string> completed(const std::vector<std::string>& words) const {
        if (!fs::exists(folder_ / "script"))
            std::ofstream(folder_ / "script") << run({"completion", "bash"}).out;
        std::string text = "source ../script\nCOMP_WORDS=(";
        for (const std::string& word : words) text += quoted(word) + " ";
        text +=
            ")\nCOMP_CWORD=" + std::to_string(words.size() - 1) +
            "\nfunction_of=$(complete -p gradwright); function_of=${function_of#*-F }; ${function_of%% *}\n"
            "[ ${#COMPREPLY[@]} = 0 ] || printf '%s\\n' \"${COMPREPLY[@]}\"\n";
        std::ofstream(folder_ / "driver") << text;
        const std::string command = "cd " + quoted((folder_ / "work").string()) +
                                    " && bash --norc -u ../driver >../out 2>../err </dev/null";
        EXPECT_EQ(std::system(command.c_str()), 0) << content(folder_ / "err");
        EXPECT_EQ(content(folder_ / "err"), "");
        std::istringstream lines(content(folder_ / "out"));
        std::vector<std::string> result;
        for (std::string line; std::getline(lines, line);) result.push_back(line);
        return result;
    }
};

TEST_F(Manual, page_has_every_verb_every_option_and_every_exit_code) {
    const std::string page = run({"manual"}).out;
    ASSERT_THAT(verbs(), testing::IsSupersetOf(
                             {"design", "init", "check", "spec", "completion", "manual", "version"}));
    for (const std::string& verb : verbs()) {
        const auto from = page.find("\n.SS " + roff(verb));
        ASSERT_NE(from, std::string::npos) << verb;
        const std::string section = page.substr(from, page.find("\n.S", from + 5) - from);
        ASSERT_THAT(options(verb), Not(IsEmpty())) << verb;
        for (const std::string& option : options(verb))
            EXPECT_THAT(section, HasSubstr("\\fB" + roff(option) + "\\fR")) << verb;
    }
    for (const char* code : {"0", "1", "2", "3", "4", "5", "6", "7", "130"})
        EXPECT_THAT(page.substr(page.find(".SH EXIT STATUS")),
                    HasSubstr(".TP\n\\fB" + std::string(code) + "\\fR\n"));
}

TEST_F(Manual, page_is_set_by_groff_without_a_warning) {
    if (std::system("command -v groff >/dev/null 2>&1") != 0) GTEST_SKIP() << "groff is not installed";
    std::ofstream(folder_ / "gradwright.1") << run({"manual"}).out;
    const std::string command =
        "groff -man -Tutf8 -P-cbou -ww -rLL=100n " + quoted((folder_ / "gradwright.1").string()) + " >" +
        quoted((folder_ / "text").string()) + " 2>" + quoted((folder_ / "said").string());
    EXPECT_EQ(std::system(command.c_str()), 0);
    EXPECT_EQ(content(folder_ / "said"), "");
    EXPECT_THAT(content(folder_ / "text"), HasSubstr("EXIT STATUS"));
}

TEST_F(Manual, completion_in_bash_knows_verbs_options_and_values) {
    EXPECT_THAT(completed({"gradwright", ""}), testing::IsSupersetOf(verbs()));
    EXPECT_THAT(completed({"gradwright", "ini"}), ElementsAre("init"));
    for (const std::string& verb : verbs()) {
        const auto offered = completed({"gradwright", verb, "--"});
        for (const std::string& option : options(verb)) EXPECT_THAT(offered, Contains(option)) << verb;
    }
    EXPECT_THAT(completed({"gradwright", "design", "--strategy", "bo"}), ElementsAre("bobyqa"));
    EXPECT_THAT(completed({"gradwright", "evaluate", "--fidelity", ""}),
                testing::UnorderedElementsAre("kinematic", "map", "full", "lammps"));
    EXPECT_THAT(completed({"gradwright", "init", "--powder-a", "IN"}), ElementsAre("IN718"));
    EXPECT_THAT(completed({"gradwright", "init", "--machine", "eos-"}), ElementsAre("eos-m290"));
    EXPECT_THAT(completed({"gradwright", "help", "spe"}), ElementsAre("spec"));
    EXPECT_THAT(completed({"gradwright", "design", "--seed", ""}), IsEmpty());
}

TEST_F(Manual, completion_in_bash_offers_studies_and_folders_with_blanks_in_their_names) {
    const fs::path work = folder_ / "work";
    fs::create_directory(work / "my runs");
    std::ofstream(work / "my study.toml") << "";
    std::ofstream(work / "my notes.txt") << "";
    EXPECT_THAT(completed({"gradwright", "check", "my"}),
                testing::UnorderedElementsAre("my study.toml", "my runs"));
    EXPECT_THAT(completed({"gradwright", "report", "my"}), ElementsAre("my runs"));
    EXPECT_THAT(completed({"gradwright", "design", "--out", "my"}), ElementsAre("my runs"));
}

TEST_F(Manual, completion_of_zsh_and_fish_is_sound_where_they_are_installed) {
    for (const char* shell : {"zsh", "fish"}) {
        const std::string script = run({"completion", shell}).out;
        for (const std::string& verb : verbs()) EXPECT_THAT(script, HasSubstr(verb)) << shell;
        EXPECT_THAT(script, HasSubstr("strategy")) << shell;
        if (std::system((std::string("command -v ") + shell + " >/dev/null 2>&1").c_str()) != 0) continue;
        std::ofstream(folder_ / "script") << script;
        EXPECT_EQ(std::system((std::string(shell) + " -n " + quoted((folder_ / "script").string())).c_str()),
                  0)
            << shell << "\n"
            << script;
    }
    const Outcome outcome = run({"completion", "bsh"});
    EXPECT_EQ(outcome.code, 2);
    EXPECT_THAT(outcome.err, HasSubstr("did you mean 'bash'?"));
}

}  // namespace
