# Sidestep. `make help` lists the targets.

BUILD    := build
SCENARIO ?= paper-c
# The name of a scene's file is understood as well.
override SCENARIO := $(patsubst %.yaml,%,$(notdir $(SCENARIO)))
FAMILY   ?= all
COUNT    ?= 500
SEED     ?= 1
PORT     ?= 7000
LAW      ?= sidestep
LOG      ?= $(shell ls -t $(BUILD)/runs/*-realtime.lcmlog 2>/dev/null | head -1)
MAKEFLAGS += -j$(shell nproc) --no-print-directory
.DEFAULT_GOAL := all

# The virtual environment's Python, and its wheel's headers of eiquadprog.
PYTHON   ?= $(BUILD)/venv/bin/python
EIQUADPROG_INCLUDE ?= $(wildcard $(BUILD)/venv/lib/python3*/site-packages/cmeel.prefix/include)
# no: install nothing, everything needed is there (packagers).
SETUP    ?= yes

# The caller may set CXX, CPPFLAGS, CXXFLAGS, LDFLAGS and LDLIBS. CXXFLAGS come last, so that another -O counts.
# The same objects go into the programs and into the library, which exports only what its header declares. No products
# and sums are contracted, so that all machines compute the same bits.
FLAGS     = -std=c++17 -O2 -ffp-contract=off -pthread -fPIC -fvisibility=hidden -Wall -Wextra -Wpedantic -Wshadow $(GCC_FLAGS)
# make sanitize: which sanitizers to build with. LCM's C++ binding casts its typed subscriptions in a form that vptr and
# null report.
FLAGS    += $(SANITIZE:%=-g1 -fsanitize=% -fno-sanitize=vptr,null -fno-sanitize-recover=all -fno-omit-frame-pointer)
# Eigen at -O2 makes gcc report uninitialised values where there are none. The parameters let gcc's memory grow to
# 500 MB before it looks for garbage, which takes a tenth of its time.
GCC_FLAGS = $(if $(findstring clang,$(CXX)),,-Wno-maybe-uninitialized \
              --param ggc-min-expand=300 --param ggc-min-heapsize=500000)
FLAGS    += $(CXXFLAGS)
WERROR   := $(if $(filter true,$(CI)),-Werror)

# The flags of packages from pkg-config, which is asked once, when the first file is compiled, else Debian's.
PKG_CONFIG ?= pkg-config
package   = $(or $(shell $(PKG_CONFIG) $(1) $(2) 2>/dev/null),$(3))
PACKAGES  = $(eval PACKAGES := $(patsubst -I%,-isystem %,$(filter-out -I/usr/include,$(call package,--cflags,eigen3,-I/usr/include/eigen3) \
              $(call package,--cflags,spdlog fmt,-DSPDLOG_COMPILED_LIB -DSPDLOG_FMT_EXTERNAL) $(call package,--cflags,yaml-cpp) $(call package,--cflags,lcm))))$(PACKAGES)
INCLUDES  = -I. -isystem $(BUILD)/lcm $(PACKAGES) -isystem $(EIQUADPROG_INCLUDE)
LIBS      = $(eval LIBS := -lassimp -lqhullcpp -lqhull_r -lurdfdom_model -lkdl_parser -lorocos-kdl $(call package,--libs,yaml-cpp,-lyaml-cpp) -lconsole_bridge \
              $(call package,--libs,spdlog fmt,-lspdlog -lfmt) $(call package,--libs,lcm,-llcm))$(LIBS)
# What --version prints; only one file needs it.
DEFINE_VERSION = -DSIDESTEP_VERSION=$(shell cat VERSION)
# Only one file includes OMPL.
OMPL_INCLUDE = $(patsubst -I%,-isystem %,$(filter-out -I/usr/include,$(call package,--cflags-only-I,ompl,-I/usr/include/ompl-1.5)))
JUDGE_LIBS = -lfcl -lccd -Wl,--push-state,--as-needed -lompl -Wl,--pop-state
COMPILE   = $(CXX) $(CPPFLAGS) $(FLAGS) $(WERROR) $(INCLUDES)
LINK      = $(CXX) $(FLAGS) $(LDFLAGS)

# host/setup/precompiled.h, compiled once; only gcc reads the result. PRECOMPILED=no: every file is compiled by itself.
PRECOMPILED ?= $(if $(SANITIZE)$(findstring clang,$(CXX)),no,yes)
HEADERS  := $(if $(filter yes,$(PRECOMPILED)),$(BUILD)/obj/precompiled.h)

# $(call progress,FILE) announces FILE with its number among the files to compile. A dry run counts them when the first
# is compiled; $(BUILD)/.compiled gets a line for each.
count     = $(eval count := $(shell mkdir -p $(BUILD); : >$(BUILD)/.compiled; MAKEFLAGS= $(MAKE) -n $(MAKEOVERRIDES) \
              COUNTING=yes $(or $(MAKECMDGOALS),all) 2>/dev/null | grep -c '^echo c++'))$(count)
progress  = @echo $(if $(COUNTING),c++,"[$$(flock $(BUILD)/.compiled sh -c 'echo >>$(BUILD)/.compiled; wc -l <$(BUILD)/.compiled')/$(count)] c++ $(1)")

sources   = $(filter-out %/main.cpp,$(shell find -H $(1) -name '*.cpp'))
objects   = $(patsubst %.cpp,$(BUILD)/obj/%.o,$(1))

FIRMWARE := $(call objects,$(call sources,firmware))
SIM      := $(call objects,$(call sources,host/sim host/people))
RELAY    := $(call objects,$(call sources,host/relay))
REPLAY   := $(call objects,$(wildcard host/replay/*.cpp))
CAMPAIGN := $(call objects,$(call sources,host/campaign))
SUPPORT  := $(call objects,$(wildcard tests/support/*.cpp))
TESTS    := $(patsubst %.cpp,$(BUILD)/%,$(shell find tests/unit tests/loop tests/faults -name '*.cpp'))
FAULTS   := $(filter $(BUILD)/tests/faults/%,$(TESTS))
# The code under the fuzzers.
FUZZED   := $(call objects,$(filter-out %/command_line.cpp %/wire.cpp, \
              $(call sources,firmware/base firmware/model firmware/io/config firmware/control firmware/io/lcm)))
FUZZERS  := $(patsubst tests/%.cpp,$(BUILD)/%,$(wildcard tests/fuzz/*.cpp))
BENCH    := $(call objects,$(wildcard tests/bench/*.cpp))
PROGRAMS := $(BUILD)/controller $(BUILD)/sim $(BUILD)/campaign $(BUILD)/replay $(BUILD)/relay $(BUILD)/arm-check
LIBRARIES := $(foreach l,support campaign relay sim firmware,$(BUILD)/lib$(l).a)
SHARED   := $(BUILD)/libsidestep.so.0
LCM_TYPES := $(wildcard lcmtypes/*.lcm lcmtypes/*/*.lcm)
WIRE     := $(BUILD)/lcm/.made
# Makes the Python types a package: pip install build/lcm/python.
PYPROJECT := $(BUILD)/lcm/python/pyproject.toml
READY    := $(BUILD)/.ready
TESTED   := $(READY).test $(BUILD)/.python-view
# Where the Python package example-robot-data has its URDFs.
ROBOTS    = $(BUILD)/venv/lib/python3*/site-packages/cmeel.prefix/share/example-robot-data/robots
SPY      := /usr/share/java/lcm.jar:/usr/share/java/jchart2d.jar

##@ The two commands

run: all ## play SCENARIO (paper-c) with LAW (sidestep or paper) in real time, then print a table and draw the figures
	@$(PYTHON) host/tools/play.py host/scenarios/$(SCENARIO).yaml --law $(LAW)

test: all $(TESTED) $(TESTS) ## run all tests; the last line is: N passed, N failed
	@$(PYTHON) tests/run.py $(TESTS)

##@ Hardening

faults: all $(TESTED) $(FAULTS) ## run the fault tests TIMES (10) times; tests/faults/README.md lists the faults
	@for n in $$(seq $(or $(TIMES),10)); do echo "round $$n"; $(PYTHON) tests/run.py $(FAULTS) || exit 1; done

peers-test: all $(BUILD)/.python-peers ## compare with Pinocchio, let other arms reach and play 100 scenes each, play with Drake's iiwa (15 min)
	@$(PYTHON) tests/peers/kinematics.py
	@$(PYTHON) tests/peers/configurations.py
	@$(PYTHON) tests/peers/reaches.py
	@$(PYTHON) tests/peers/iiwa.py
	@$(PYTHON) tests/peers/scenes.py

fuzz: all $(READY).fuzz ## fuzz messages, URDF and configuration under ASan and UBSan, SECONDS (60) each
	@$(MAKE) $(FUZZERS)
	@tests/fuzz/run $(or $(SECONDS),60)

sanitize: all $(TESTED) ## run all tests under ASan and UBSan, those with threads under TSan
	@MAKEFLAGS= tests/sanitize

arm64: all $(READY).test $(READY).arm64 $(BUILD)/arm64/.sysroot ## build for arm64 in build/arm64, run the unit tests under qemu
	@MAKEFLAGS= tests/arm64

##@ Building

setup: $(READY) $(TESTED) $(READY).lint ## only install what is missing: Debian packages and build/venv (SETUP=no: no target does)

all: $(PROGRAMS) $(PYPROJECT) ## set up what is missing and build the programs

campaign: all ## run the witnessed benchmark: FAMILY (default all), COUNT (500), SEED (1), LAW (sidestep)
	@$(BUILD)/campaign --family $(FAMILY) --count $(COUNT) --seed $(SEED) --law $(LAW)

bench: $(BUILD)/bench $(BUILD)/.python-robots ## measure the CPU time of a hot step, of the baseline computation and of the planner
	@$(BUILD)/bench $$(ls $(ROBOTS)/panda_description/urdf/panda.urdf 2>/dev/null)

figures: all ## draw the figures of all one-arm scenarios with both laws, and the trade-off over the paper's gains
	@$(PYTHON) host/tools/figures.py

animation: all ## draw SCENARIO as an animated GIF of both laws in build/figures
	@$(PYTHON) host/tools/animation.py host/scenarios/$(SCENARIO).yaml

docs: all $(BUILD)/.python-view ## make the tables and pictures of README.md and docs/results.md that come from scenarios
	@$(PYTHON) host/tools/docs.py

timing: all $(READY).timing ## measure the real-time loop and cyclictest, idle and under CPU load, SECONDS (30) each
	@$(PYTHON) host/tools/timing.py --duration $(or $(SECONDS),30)

soak: all $(READY).timing ## run one controller for SECONDS (3600) and kill its simulator at random times
	@$(PYTHON) host/tools/soak.py --duration $(or $(SECONDS),3600)

##@ Installing

install: all $(SHARED) ## install programs, library, manual pages and service below DESTDIR and PREFIX (/usr/local)
	@BUILD=$(BUILD) host/install/install

uninstall: all $(SHARED) ## remove what `make install` with the same PREFIX installed
	@BUILD=$(BUILD) host/install/install undo

deb: all $(SHARED) $(READY).deb ## build a Debian package, build/sidestep_VERSION_ARCHITECTURE.deb
	@BUILD=$(BUILD) host/install/deb

install-test: all $(SHARED) $(READY).test $(READY).deb $(READY).install ## test the installation, the package and the example outside the source tree
	@tests/install

##@ Viewing

view: all $(BUILD)/.python-view ## play SCENARIO live in the browser on PORT (7000), repeated until Ctrl-C
	@$(PYTHON) host/view/show.py host/scenarios/$(SCENARIO).yaml --port $(PORT)

play: all $(BUILD)/.python-view ## show an arm without target and obstacles, and the commands that send them
	@$(PYTHON) host/view/show.py host/scenarios/play.yaml --port $(PORT)

view-test: all $(READY).view-test $(BUILD)/.python-view ## check view and report in headless Chromium: screenshots in build/figures, frames a second
	@$(PYTHON) tests/view/picture.py
	@$(PYTHON) tests/view/rate.py
	@$(PYTHON) tests/view/report_picture.py

spy: $(if $(DISPLAY),$(BUILD)/types.jar) ## start lcm-spy, which decodes the message types
	@test -n "$$DISPLAY" || { echo "lcm-spy needs a display, DISPLAY is not set; without one: host/tools/watch.py" >&2; exit 2; }
	@java -cp $(SPY):$< lcm.spy.Spy

report: all $(BUILD)/.python-view ## write build/report.html about LOG (an lcm-logger log; default: of the last `make run`) of the arm of CONFIG
	@test -n "$(LOG)" || { echo "no run is recorded yet: make run, or give a log with LOG="; exit 2; }
	@$(PYTHON) host/tools/report.py "$(LOG)" $(if $(CONFIG),--config "$(CONFIG)") -o $(BUILD)/report.html

##@ Checking

lint: $(WIRE) $(READY).lint ## check all sources with clang-format and cppcheck, the programs also with clang-tidy
	@host/setup/lint $(INCLUDES) $(OMPL_INCLUDE) $(DEFINE_VERSION)

clean: ## remove what was built; keep the virtual environment, runs and figures
	rm -rf $(BUILD)/fuzz $(BUILD)/sanitize $(BUILD)/arm64 $(BUILD)/obj $(BUILD)/lcm $(BUILD)/tests $(PROGRAMS) $(BUILD)/bench $(BUILD)/.flags $(BUILD)/.objects $(BUILD)/*.a $(BUILD)/*.jar \
	  $(SHARED) $(BUILD)/stage $(BUILD)/deb $(BUILD)/*.deb $(BUILD)/shlibdeps

help: ## print this list
	@awk 'BEGIN {FS = ":.*## "} /^##@/ {printf "\n%s\n", substr($$0, 5)} \
	  /^[a-z0-9-]+:.*## / {printf "  make %-12s %s\n", $$1, $$2}' Makefile
	@printf '\nScenes (SCENARIO=NAME)\n'
	@awk -F '"' '/^title:/ {name = FILENAME; sub(".*/", "", name); sub(".yaml", "", name); printf "  %-20s %s\n", name, $$2}' \
	  host/scenarios/*.yaml

.PHONY: always setup all run test peers-test faults fuzz sanitize arm64 campaign bench figures animation docs timing soak install uninstall deb install-test view play view-test spy report lint clean help

# Set-up: Debian packages, then the virtual environment. The stamps make a second call start at once.
ifeq ($(SETUP),no)
$(READY): ;
$(READY).%: ;
$(BUILD)/.python-%: ;
else
$(READY): host/setup/debian.txt host/setup/python.txt
	@mkdir -p $(@D)
	@host/setup/debian build
	@test -x $(BUILD)/venv/bin/python || { echo "set-up: making the virtual environment $(BUILD)/venv"; python3 -m venv $(BUILD)/venv; }
	@echo "set-up: Python packages of host/setup/python.txt"
	@$(BUILD)/venv/bin/python -m pip install -q --disable-pip-version-check -r host/setup/python.txt
	@touch $@

$(READY).%: host/setup/debian.txt | $(READY)
	@host/setup/debian $*
	@touch $@

# One at a time, since pip does not wait for itself.
$(BUILD)/.python-%: host/setup/python-%.txt | $(READY)
	@echo "set-up: Python packages of $<"
	@flock $(BUILD)/venv $(BUILD)/venv/bin/python -m pip install -q --disable-pip-version-check -r $<
	@touch $@
endif

$(BUILD)/%/.sysroot: host/setup/debian.txt host/setup/sysroot | $(READY)
	@host/setup/sysroot $* $(@D)/sysroot
	@touch $@

# Debian's lcm-spy script passes an option that its Java no longer knows.
$(BUILD)/types.jar: $(WIRE) | $(READY).spy
	@rm -rf $(BUILD)/lcm/java && lcm-gen -j --jpath $(BUILD)/lcm/java $(LCM_TYPES)
	@javac -nowarn -cp $(SPY) $$(find $(BUILD)/lcm/java -name '*.java')
	@jar cf $@ -C $(BUILD)/lcm/java .

$(WIRE): $(LCM_TYPES) | $(READY)
	@mkdir -p $(@D)
	lcm-gen -x --cpp-hpath $(BUILD)/lcm $(LCM_TYPES)
	lcm-gen -p --ppath $(BUILD)/lcm/python $(LCM_TYPES)
	@touch $@

$(PYPROJECT): host/setup/pyproject.toml.in VERSION $(WIRE)
	@sed "s/@VERSION@/$$(cat VERSION)/" $< >$@

# Each changes when its text does: then everything is compiled again, or the libraries lose objects without a source.
$(BUILD)/.flags: private TEXT = $(CXX) $(CPPFLAGS) $(FLAGS) $(HEADERS)
$(BUILD)/.objects: private TEXT = $(FIRMWARE) $(SIM) $(RELAY) $(REPLAY) $(CAMPAIGN) $(SUPPORT) $(BENCH)
$(BUILD)/.flags $(BUILD)/.objects: $(if $(COUNTING),,always) | $(READY)
	@mkdir -p $(@D)
	@echo '$(TEXT)' | cmp -s - $@ || echo '$(TEXT)' >$@

$(BUILD)/obj/precompiled.h: host/setup/precompiled.h | $(READY)
	@mkdir -p $(@D)
	@cp $< $@

$(BUILD)/obj/precompiled.h.gch: $(BUILD)/obj/precompiled.h $(BUILD)/.flags
	$(call progress,host/setup/precompiled.h)
	@$(COMPILE) -x c++-header $< -o $@

$(BUILD)/obj/%.o: %.cpp $(WIRE) $(BUILD)/.flags $(HEADERS:=.gch) | $(READY)
	@mkdir -p $(@D)
	$(call progress,$<)
	@$(COMPILE) $(HEADERS:%=-include %) -MMD -MP -c $< -o $@

# The command line is read once, at the start, and optimising CLI11's templates takes half of this file's compile time:
# -O0, whatever CXXFLAGS say. The precompiled header was made at another level of optimisation; gcc would not use it.
$(BUILD)/obj/firmware/base/command_line.o: private FLAGS += -O0
$(BUILD)/obj/firmware/base/command_line.o: private HEADERS :=
$(BUILD)/obj/firmware/base/command_line.o: private INCLUDES += $(DEFINE_VERSION)
$(BUILD)/obj/firmware/base/command_line.o: VERSION

$(BUILD)/obj/host/campaign/furniture/path_planner.o: private INCLUDES += $(OMPL_INCLUDE)

# Only the tests need cmocka.
$(SUPPORT) $(TESTS:$(BUILD)/%=$(BUILD)/obj/%.o): | $(READY).test

$(BUILD)/libfirmware.a: $(FIRMWARE)
$(BUILD)/libsim.a: $(SIM)
$(BUILD)/libcampaign.a: $(CAMPAIGN)
$(BUILD)/librelay.a: $(RELAY)
$(BUILD)/libsupport.a: $(SUPPORT)
$(LIBRARIES): $(BUILD)/.objects
$(BUILD)/lib%.a:
	@rm -f $@ && $(AR) rcs $@ $(filter %.o,$^)

$(BUILD)/controller: $(BUILD)/obj/firmware/main.o $(BUILD)/libfirmware.a
	@$(LINK) $^ $(LIBS) $(LDLIBS) -o $@

$(BUILD)/sim: $(BUILD)/obj/host/sim/main.o $(BUILD)/libsim.a $(BUILD)/libfirmware.a
	@$(LINK) $^ -lfcl -lccd $(LIBS) $(LDLIBS) -o $@

$(BUILD)/campaign: $(BUILD)/obj/host/campaign/main.o $(BUILD)/libcampaign.a $(BUILD)/libsim.a $(BUILD)/libfirmware.a
	@$(LINK) $^ $(JUDGE_LIBS) $(LIBS) $(LDLIBS) -o $@

$(BUILD)/replay: $(REPLAY) $(BUILD)/libfirmware.a
	@$(LINK) $^ $(LIBS) $(LDLIBS) -o $@

$(BUILD)/relay: $(BUILD)/obj/host/relay/main.o $(BUILD)/librelay.a $(BUILD)/libfirmware.a
	@$(LINK) $^ $(LIBS) $(LDLIBS) -o $@

$(BUILD)/arm-check: $(BUILD)/obj/host/arm_check/main.o $(BUILD)/libfirmware.a
	@$(LINK) $^ $(LIBS) $(LDLIBS) -o $@

# The library for other processes. It exports only what firmware/library/sidestep.h declares.
$(SHARED): $(BUILD)/obj/firmware/library/controller.o $(BUILD)/libfirmware.a
	@$(LINK) -shared -Wl,-soname,$(@F) -Wl,--no-undefined -Wl,--as-needed $^ $(LIBS) $(LDLIBS) -o $@

$(BUILD)/bench: $(BENCH) $(LIBRARIES)
	@$(LINK) $^ $(JUDGE_LIBS) -lcmocka $(LIBS) $(LDLIBS) -o $@

$(TESTS): $(BUILD)/tests/%: $(BUILD)/obj/tests/%.o $(LIBRARIES) $(PROGRAMS)
	@mkdir -p $(@D)
	@$(LINK) $(filter %.o %.a,$^) $(JUDGE_LIBS) -lcmocka $(LIBS) $(LDLIBS) -o $@

FUZZ = clang++-14 $(filter-out $(GCC_FLAGS),$(FLAGS)) -fno-sanitize-recover=all
$(BUILD)/fuzz/obj/%.o: %.cpp $(WIRE)
	@mkdir -p $(@D)
	@echo "clang++ $<"
	@$(FUZZ) -fsanitize=fuzzer-no-link,address,undefined $(CPPFLAGS) $(INCLUDES) -MMD -MP -c $< -o $@

$(FUZZERS): $(BUILD)/fuzz/%: $(BUILD)/fuzz/obj/tests/fuzz/%.o $(FUZZED:$(BUILD)/%=$(BUILD)/fuzz/%)
	@$(FUZZ) -fsanitize=fuzzer,address,undefined $(LDFLAGS) $^ $(LIBS) $(LDLIBS) -o $@

.SECONDARY:
-include $(shell find $(BUILD)/obj $(BUILD)/fuzz -name '*.d' 2>/dev/null)
