function plan = buildfile()
%BUILDFILE What MATLAB's buildtool (R2022b and later) can do here: mex, test, toolbox.
%   This has not been run in MATLAB yet.
%
%   Example:
%      buildtool test
%
%   See also buildtool, build_mex, package_toolbox.

% SPDX-License-Identifier: MIT
plan = buildplan(localfunctions());
plan.DefaultTasks = "test";
plan("test").Dependencies = "mex";
plan("toolbox").Dependencies = "mex";
end

function mexTask(~)
% Build the MEX file
build_mex('-R2018a');
end

function testTask(~)
% Run the tests
addpath(fullfile(pwd, 'toolbox'));
assertSuccess(runtests(fullfile('tests', 'matlab')));
end

function toolboxTask(~)
% Make roburoc4.mltbx
package_toolbox();
end
