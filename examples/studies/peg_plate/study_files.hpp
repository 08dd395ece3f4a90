// SPDX-License-Identifier: Apache-2.0
// The folder of one set and seed: samples, lessons, networks, result, pictures. What is there already is not
// made again, so an interrupted study goes on where it was.
#pragma once

#include <filesystem>
#include <optional>

#include "examples/studies/peg_plate/study.hpp"

namespace aussois {

/// Makes FOLDER and writes options.json, or compares with it. Throws std::invalid_argument naming the first
/// option in which they differ.
void claim_folder(const std::filesystem::path& folder, const PegStudyOptions& options);

/// FOLDER/samples/000.csv.
std::filesystem::path samples_file(const std::filesystem::path& folder, int index);
void write_samples(const std::filesystem::path& path, const std::vector<PegSample>& samples);
std::vector<PegSample> read_samples(const std::filesystem::path& path);  // throws std::runtime_error
/// All cases; throws std::runtime_error naming the first that is missing.
PegData read_data(const std::filesystem::path& folder, int cases);

/// What training leaves besides its networks: lessons.json.
void write_lessons(const std::filesystem::path& path, const LessonsLearnt& lessons);
/// Nothing: not there, or damaged, or of a choice that the scenario has not.
std::optional<LessonsLearnt> read_lessons(const std::filesystem::path& path, PegScenario scenario);

void write_result(const std::filesystem::path& path, const PegResult& result);
/// Nothing: not there, damaged, or of another set or seed.
std::optional<PegResult> read_result(const std::filesystem::path& path, const std::string& set,
                                     std::uint64_t seed);

/// training.json of a seed: what A-5 is judged by. Read: nothing if it is not there, of another seed, or
/// damaged.
void write_training_check(const std::filesystem::path& path, const TrainingCheck& check);
std::optional<TrainingCheck> read_training_check(const std::filesystem::path& path, std::uint64_t seed);

/// forces.png: |F| over one test case, measured and by methods; choices.png: what the network chooses, with
/// centres of pressure (surface) or by normal (edge); each with its CSV and gnuplot script. False: gnuplot is
/// not there, or fails.
bool write_pictures(const std::filesystem::path& folder, const PegData& data, const std::vector<int>& cases,
                    const std::vector<NamedMethod>& methods, const Network& network,
                    const PegStudyOptions& options);

}  // namespace aussois
