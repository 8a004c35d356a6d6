# Sidestep. `make help` lists the targets.

BUILD    := build
SCENARIO ?= paper-c
FAMILY   ?= all
COUNT    ?= 500
SEED     ?= 1
LAW      ?= sidestep
LOG      ?= $(shell ls -t $(BUILD)/runs/*-realtime.lcmlog 2>/dev/null | head -1)
MAKEFLAGS += -j$(shell nproc) --no-print-directory
.DEFAULT_GOAL := all

PYTHON   := $(BUILD)/venv/bin/python
SITE      = $(wildcard $(BUILD)/venv/lib/python3*/site-packages)
# Eigen at -O2 makes gcc see uninitialised values where there are none.
CXXFLAGS := -std=c++17 -O2 -g1 -pthread -Wall -Wextra -Wpedantic -Wshadow -Wno-maybe-uninitialized -Werror
# The same objects go into the programs and into the library, which shows no more than its header does.
CXXFLAGS += -fPIC -fvisibility=hidden
# make sanitize: which sanitizers to build with. The typed subscriptions of LCM's C++ binding are what they must not see.
CXXFLAGS += $(SANITIZE:%=-fsanitize=% -fno-sanitize=vptr,null -fno-sanitize-recover=all -fno-omit-frame-pointer)
INCLUDES  = -I. -isystem $(BUILD)/lcm -isystem /usr/include/eigen3 -isystem $(SITE)/cmeel.prefix/include
LIBS     := -lassimp -lurdfdom_model -lkdl_parser -lorocos-kdl -lyaml-cpp -lconsole_bridge -lspdlog -lfmt -llcm

sources   = $(filter-out %/main.cpp,$(shell find $(1) -name '*.cpp'))
objects   = $(patsubst %.cpp,$(BUILD)/obj/%.o,$(1))

FIRMWARE := $(call objects,$(call sources,firmware))
SIM      := $(call objects,$(call sources,host/sim))
RELAY    := $(call objects,$(call sources,host/relay))
REPLAY   := $(call objects,$(wildcard host/replay/*.cpp))
CAMPAIGN := $(call objects,$(call sources,host/campaign))
SUPPORT  := $(call objects,$(wildcard tests/support/*.cpp))
TESTS    := $(patsubst %.cpp,$(BUILD)/%,$(shell find tests/unit tests/loop tests/faults -name '*.cpp'))
FAULTS   := $(filter $(BUILD)/tests/faults/%,$(TESTS))
# What the fuzzers look at.
FUZZED   := $(call objects,$(call sources,firmware/base firmware/model firmware/io/config) \
              $(wildcard firmware/control/*.cpp) $(filter-out %/wire.cpp,$(wildcard firmware/io/lcm/*.cpp)))
FUZZERS  := $(patsubst tests/%.cpp,$(BUILD)/%,$(wildcard tests/fuzz/*.cpp))
BENCH    := $(call objects,$(wildcard tests/bench/*.cpp))
PROGRAMS := $(BUILD)/controller $(BUILD)/sim $(BUILD)/campaign $(BUILD)/replay $(BUILD)/relay $(BUILD)/arm-check
LIBRARIES := $(foreach l,support campaign relay sim firmware,$(BUILD)/lib$(l).a)
SHARED   := $(BUILD)/libsidestep.so.0
LCM_TYPES := $(wildcard lcmtypes/*.lcm lcmtypes/*/*.lcm)
WIRE     := $(BUILD)/lcm/.made
READY    := $(BUILD)/.ready
VIEW     := $(READY).view $(BUILD)/.python-view
SPY      := /usr/share/java/lcm.jar:/usr/share/java/jchart2d.jar

##@ The two commands

run: all ## play SCENARIO (default paper-c) in real time, then the table and the figures
	@$(PYTHON) host/tools/play.py host/scenarios/$(SCENARIO).yaml

test: all $(READY).test $(TESTS) ## run every test; ends with one line: N passed, N failed
	@$(PYTHON) tests/run.py $(TESTS)

##@ Hardening

faults: all $(READY).test $(FAULTS) ## the fault tests TIMES (10) in a row; what each injects: tests/faults/README.md
	@for n in $$(seq $(or $(TIMES),10)); do echo "round $$n"; $(PYTHON) tests/run.py $(FAULTS) || exit 1; done

peers-test: all $(BUILD)/.python-peers ## Pinocchio, 100 witnessed scenes with arms of others, Drake's iiwa in the loop (10 min)
	@$(PYTHON) tests/peers/kinematics.py
	@$(PYTHON) tests/peers/iiwa.py
	@$(PYTHON) tests/peers/scenes.py

fuzz: all $(READY).fuzz ## fuzz messages, URDF and configuration under ASan and UBSan for SECONDS (60) each
	@$(MAKE) $(FUZZERS)
	@tests/fuzz/run $(or $(SECONDS),60)

sanitize: all $(READY).test ## all tests under ASan and UBSan, those with threads under TSan
	@MAKEFLAGS= tests/sanitize

arm64: all $(READY).test $(READY).arm64 $(BUILD)/arm64/.sysroot ## build for arm64 in build/arm64, run the unit tests under qemu
	@MAKEFLAGS= tests/arm64

##@ Building

all: $(PROGRAMS) ## set up what is missing and build the programs

campaign: all ## the witnessed benchmark: FAMILY (default all), COUNT (500), SEED (1), LAW (sidestep)
	@$(BUILD)/campaign --family $(FAMILY) --count $(COUNT) --seed $(SEED) --law $(LAW)

bench: $(BUILD)/bench ## CPU time of a control cycle beside the bare computation
	@$(BUILD)/bench

figures: all ## figures of all scenarios of one arm, both laws, and the trade-off over the paper's gains
	@$(PYTHON) host/tools/figures.py

timing: all $(READY).timing ## the real-time loop beside cyclictest, idle and under CPU stress, SECONDS (30) each
	@$(PYTHON) host/tools/timing.py --duration $(or $(SECONDS),30)

soak: all $(READY).timing ## one controller for SECONDS (3600) while its simulator is killed at random moments
	@$(PYTHON) host/tools/soak.py --duration $(or $(SECONDS),3600)

##@ Installing

install: all $(SHARED) ## programs, library, manual pages, service: below PREFIX (/usr/local), with DESTDIR before it
	@BUILD=$(BUILD) host/install/install

uninstall: all $(SHARED) ## remove what the same `make install` made
	@BUILD=$(BUILD) host/install/install undo

deb: all $(SHARED) $(READY).deb ## the same as a Debian package, build/sidestep_VERSION_ARCHITECTURE.deb
	@BUILD=$(BUILD) host/install/deb

install-test: all $(SHARED) $(READY).test $(READY).deb $(READY).install ## install, package and example, tried outside the source tree
	@tests/install

##@ Looking

view: all $(VIEW) ## SCENARIO live in the browser, again and again until Ctrl-C
	@$(PYTHON) host/view/show.py host/scenarios/$(SCENARIO).yaml

view-test: all $(VIEW) ## the same in headless Chromium; examines a screenshot, build/figures/view.png
	@$(PYTHON) tests/view/picture.py

spy: $(BUILD)/types.jar ## lcm-spy with the types decoded
	@java -cp $(SPY):$< lcm.spy.Spy

report: all ## LOG (any lcm-logger log of a run; default: that of the last `make run`) as one page, build/report.html
	@$(PYTHON) host/tools/report.py $(or $(LOG),no-run-yet) -o $(BUILD)/report.html

##@ Checking

lint: all $(READY).lint ## clang-format, clang-tidy and cppcheck
	@host/setup/lint

clean: ## remove what was built, but not the virtual environment, runs and figures
	rm -rf $(BUILD)/fuzz $(BUILD)/sanitize $(BUILD)/arm64 $(BUILD)/obj $(BUILD)/lcm $(BUILD)/tests $(PROGRAMS) $(BUILD)/bench $(BUILD)/*.a $(BUILD)/*.jar \
	  $(SHARED) $(BUILD)/stage $(BUILD)/deb $(BUILD)/*.deb $(BUILD)/shlibdeps

help: ## this list
	@awk 'BEGIN {FS = ":.*## "} /^##@/ {printf "\n%s\n", substr($$0, 5)} \
	  /^[a-z0-9-]+:.*## / {printf "  make %-12s %s\n", $$1, $$2}' Makefile

.PHONY: all run test peers-test faults fuzz sanitize arm64 campaign bench figures timing soak install uninstall deb install-test view view-test spy report lint clean help

# Set-up: Debian packages, then the virtual environment. The stamps make a second call start at once.
$(READY): host/setup/debian.txt host/setup/python.txt
	@host/setup/debian build
	@test -x $(PYTHON) || { echo "set-up: making the virtual environment $(BUILD)/venv"; python3 -m venv $(BUILD)/venv; }
	@echo "set-up: Python packages of host/setup/python.txt"
	@$(PYTHON) -m pip install -q --disable-pip-version-check -r host/setup/python.txt
	@touch $@

$(READY).%: host/setup/debian.txt | $(READY)
	@host/setup/debian $*
	@touch $@

$(BUILD)/.python-%: host/setup/python-%.txt | $(READY)
	@echo "set-up: Python packages of $<"
	@$(PYTHON) -m pip install -q --disable-pip-version-check -r $<
	@touch $@

$(BUILD)/%/.sysroot: host/setup/debian.txt host/setup/sysroot | $(READY)
	@host/setup/sysroot $* $(@D)/sysroot
	@touch $@

# Debian's lcm-spy script passes an option that its Java no longer knows.
$(BUILD)/types.jar: $(WIRE) $(READY).spy
	@rm -rf $(BUILD)/lcm/java && lcm-gen -j --jpath $(BUILD)/lcm/java $(LCM_TYPES)
	@javac -nowarn -cp $(SPY) $$(find $(BUILD)/lcm/java -name '*.java')
	@jar cf $@ -C $(BUILD)/lcm/java .

$(WIRE): $(LCM_TYPES) | $(READY)
	@mkdir -p $(@D)
	lcm-gen -x --cpp-hpath $(BUILD)/lcm $(LCM_TYPES)
	lcm-gen -p --ppath $(BUILD)/lcm/python $(LCM_TYPES)
	@touch $@

$(BUILD)/obj/%.o: %.cpp $(WIRE) | $(READY)
	@mkdir -p $(@D)
	@echo "c++ $<"
	@$(CXX) $(CXXFLAGS) $(INCLUDES) -MMD -MP -c $< -o $@

# These need cmocka, which the programs do not.
$(SUPPORT) $(TESTS:$(BUILD)/%=$(BUILD)/obj/%.o): | $(READY).test

$(BUILD)/libfirmware.a: $(FIRMWARE)
$(BUILD)/libsim.a: $(SIM)
$(BUILD)/libcampaign.a: $(CAMPAIGN)
$(BUILD)/librelay.a: $(RELAY)
$(BUILD)/libsupport.a: $(SUPPORT)
$(BUILD)/lib%.a:
	@rm -f $@ && $(AR) rcs $@ $^

$(BUILD)/controller: $(BUILD)/obj/firmware/main.o $(BUILD)/libfirmware.a
	@$(CXX) $(CXXFLAGS) $^ $(LIBS) -o $@

$(BUILD)/sim: $(BUILD)/obj/host/sim/main.o $(BUILD)/libsim.a $(BUILD)/libfirmware.a
	@$(CXX) $(CXXFLAGS) $^ -lfcl -lccd $(LIBS) -o $@

$(BUILD)/campaign: $(BUILD)/obj/host/campaign/main.o $(BUILD)/libcampaign.a $(BUILD)/libsim.a $(BUILD)/libfirmware.a
	@$(CXX) $(CXXFLAGS) $^ -lfcl -lccd $(LIBS) -o $@

$(BUILD)/replay: $(REPLAY) $(BUILD)/libfirmware.a
	@$(CXX) $(CXXFLAGS) $^ $(LIBS) -o $@

$(BUILD)/relay: $(BUILD)/obj/host/relay/main.o $(BUILD)/librelay.a
	@$(CXX) $(CXXFLAGS) $^ $(LIBS) -o $@

$(BUILD)/arm-check: $(BUILD)/obj/host/arm_check/main.o $(BUILD)/libfirmware.a
	@$(CXX) $(CXXFLAGS) $^ $(LIBS) -o $@

# The library for processes of others: firmware/library/sidestep.h is all that can be seen of it.
$(SHARED): $(BUILD)/obj/firmware/library/controller.o $(BUILD)/libfirmware.a
	@$(CXX) $(CXXFLAGS) -shared -Wl,-soname,$(@F) -Wl,--no-undefined -Wl,--as-needed $^ $(LIBS) -o $@

$(BUILD)/bench: $(BENCH) $(LIBRARIES)
	@$(CXX) $(CXXFLAGS) $^ -lfcl -lccd -lcmocka $(LIBS) -o $@

$(TESTS): $(BUILD)/tests/%: $(BUILD)/obj/tests/%.o $(LIBRARIES) $(PROGRAMS)
	@mkdir -p $(@D)
	@$(CXX) $(CXXFLAGS) $(filter %.o %.a,$^) -lfcl -lccd -lcmocka $(LIBS) -o $@

FUZZFLAGS = $(filter-out -Werror -Wno-maybe-uninitialized,$(CXXFLAGS)) -fno-sanitize-recover=all
$(BUILD)/fuzz/obj/%.o: %.cpp $(WIRE)
	@mkdir -p $(@D)
	@echo "clang++ $<"
	@clang++-14 $(FUZZFLAGS) -fsanitize=fuzzer-no-link,address,undefined $(INCLUDES) -MMD -MP -c $< -o $@

$(FUZZERS): $(BUILD)/fuzz/%: $(BUILD)/fuzz/obj/tests/fuzz/%.o $(FUZZED:$(BUILD)/%=$(BUILD)/fuzz/%)
	@clang++-14 $(FUZZFLAGS) -fsanitize=fuzzer,address,undefined $^ $(LIBS) -o $@

.SECONDARY:
-include $(shell find $(BUILD)/obj $(BUILD)/fuzz -name '*.d' 2>/dev/null)
