# Sidestep. `make help` lists the targets.

BUILD    := build
SCENARIO ?= paper-c
FAMILY   ?= all
COUNT    ?= 500
SEED     ?= 1
LAW      ?= sidestep
MAKEFLAGS += -j$(shell nproc) --no-print-directory
.DEFAULT_GOAL := all

PYTHON   := $(BUILD)/venv/bin/python
SITE      = $(wildcard $(BUILD)/venv/lib/python3*/site-packages)
# Eigen at -O2 makes gcc see uninitialised values where there are none.
CXXFLAGS := -std=c++17 -O2 -g1 -pthread -Wall -Wextra -Wpedantic -Wshadow -Wno-maybe-uninitialized -Werror
INCLUDES  = -I. -isystem $(BUILD)/lcm -isystem /usr/include/eigen3 -isystem $(SITE)/cmeel.prefix/include
LIBS     := -lurdfdom_model -lkdl_parser -lorocos-kdl -lyaml-cpp -lconsole_bridge -lspdlog -lfmt -llcm

sources   = $(filter-out %/main.cpp,$(wildcard $(1)))
objects   = $(patsubst %.cpp,$(BUILD)/obj/%.o,$(1))

FIRMWARE := $(call objects,$(call sources,firmware/*/*.cpp))
SIM      := $(call objects,$(call sources,host/sim/*.cpp))
REPLAY   := $(call objects,$(wildcard host/replay/*.cpp))
CAMPAIGN := $(call objects,$(call sources,host/campaign/*.cpp))
SUPPORT  := $(call objects,$(wildcard tests/support/*.cpp))
TESTS    := $(patsubst %.cpp,$(BUILD)/%,$(wildcard tests/unit/*.cpp tests/loop/*.cpp tests/faults/*.cpp))
PROGRAMS := $(BUILD)/controller $(BUILD)/sim $(BUILD)/campaign $(BUILD)/replay
BENCH    := $(call objects,$(wildcard tests/bench/*.cpp))
LIBRARIES := $(foreach l,support campaign sim firmware,$(BUILD)/lib$(l).a)
WIRE     := $(BUILD)/lcm/.made
READY    := $(BUILD)/.ready

##@ The two commands

run: all ## play SCENARIO (default paper-c) in real time, then the table and the figures
	@$(PYTHON) host/tools/play.py host/scenarios/$(SCENARIO).yaml

test: all $(READY).test $(TESTS) ## run every test; ends with one line: N passed, N failed
	@$(PYTHON) tests/run.py $(TESTS)

##@ Building

all: $(PROGRAMS) ## set up what is missing and build the programs

campaign: all ## the witnessed benchmark: FAMILY (default all), COUNT (500), SEED (1), LAW (sidestep)
	@$(BUILD)/campaign --family $(FAMILY) --count $(COUNT) --seed $(SEED) --law $(LAW)

bench: $(BUILD)/bench ## CPU time of a control cycle beside the bare computation
	@$(BUILD)/bench

figures: all ## figures of the paper's three simulations, both laws, and the trade-off over the gains
	@$(PYTHON) host/tools/figures.py

timing: all $(READY).timing ## the real-time loop beside cyclictest, idle and under CPU stress, SECONDS (30) each
	@$(PYTHON) host/tools/timing.py --duration $(or $(SECONDS),30)

soak: all $(READY).timing ## one controller for SECONDS (3600) while its simulator is killed at random moments
	@$(PYTHON) host/tools/soak.py --duration $(or $(SECONDS),3600)

lint: all $(READY).lint ## clang-format, clang-tidy and cppcheck
	@host/setup/lint

clean: ## remove what was built, but not the virtual environment
	rm -rf $(BUILD)/obj $(BUILD)/lcm $(BUILD)/tests $(PROGRAMS) $(BUILD)/bench $(BUILD)/*.a

help: ## this list
	@awk 'BEGIN {FS = ":.*## "} /^##@/ {printf "\n%s\n", substr($$0, 5)} \
	  /^[a-z-]+:.*## / {printf "  make %-10s %s\n", $$1, $$2}' Makefile

.PHONY: all run test campaign bench figures timing soak lint clean help

# Set-up: Debian packages, then the virtual environment. The stamps make a second call start at once.
$(READY): host/setup/debian.txt host/setup/python.txt
	@host/setup/debian build
	@test -x $(PYTHON) || { echo "set-up: making the virtual environment $(BUILD)/venv"; python3 -m venv $(BUILD)/venv; }
	@echo "set-up: Python packages of host/setup/python.txt"
	@$(BUILD)/venv/bin/pip install -q --disable-pip-version-check -r host/setup/python.txt
	@touch $@

$(READY).%: host/setup/debian.txt | $(READY)
	@host/setup/debian $*
	@touch $@

$(WIRE): $(wildcard lcmtypes/*.lcm) | $(READY)
	@mkdir -p $(@D)
	lcm-gen -x --cpp-hpath $(BUILD)/lcm lcmtypes/*.lcm
	lcm-gen -p --ppath $(BUILD)/lcm/python lcmtypes/*.lcm
	@touch $@

$(BUILD)/obj/%.o: %.cpp $(WIRE) | $(READY)
	@mkdir -p $(@D)
	@echo "c++ $<"
	@$(CXX) $(CXXFLAGS) $(INCLUDES) -MMD -MP -c $< -o $@

$(BUILD)/libfirmware.a: $(FIRMWARE)
$(BUILD)/libsim.a: $(SIM)
$(BUILD)/libcampaign.a: $(CAMPAIGN)
$(BUILD)/libsupport.a: $(SUPPORT)
$(BUILD)/lib%.a:
	@rm -f $@ && ar rcs $@ $^

$(BUILD)/controller: $(BUILD)/obj/firmware/main.o $(BUILD)/libfirmware.a
	@$(CXX) $(CXXFLAGS) $^ $(LIBS) -o $@

$(BUILD)/sim: $(BUILD)/obj/host/sim/main.o $(BUILD)/libsim.a $(BUILD)/libfirmware.a
	@$(CXX) $(CXXFLAGS) $^ -lfcl -lccd $(LIBS) -o $@

$(BUILD)/campaign: $(BUILD)/obj/host/campaign/main.o $(BUILD)/libcampaign.a $(BUILD)/libsim.a $(BUILD)/libfirmware.a
	@$(CXX) $(CXXFLAGS) $^ $(LIBS) -o $@

$(BUILD)/replay: $(REPLAY) $(BUILD)/libfirmware.a
	@$(CXX) $(CXXFLAGS) $^ $(LIBS) -o $@

$(BUILD)/bench: $(BENCH) $(LIBRARIES)
	@$(CXX) $(CXXFLAGS) $^ -lfcl -lccd -lcmocka $(LIBS) -o $@

$(TESTS): $(BUILD)/tests/%: $(BUILD)/obj/tests/%.o $(LIBRARIES) $(PROGRAMS)
	@mkdir -p $(@D)
	@$(CXX) $(CXXFLAGS) $(filter %.o %.a,$^) -lfcl -lccd -lcmocka $(LIBS) -o $@

.SECONDARY:
-include $(shell find $(BUILD)/obj -name '*.d' 2>/dev/null)
