classdef Roburoc4Test < matlab.unittest.TestCase
%ROBUROC4TEST The tests of the roburoc4 package for MATLAB's runtests.
%   In MATLAB nobody of this project has run it yet; the tests themselves run in Octave.
%
%   Example:
%      build_mex; addpath toolbox; runtests('tests/matlab')
%
%   See also run_tests.

% SPDX-License-Identifier: MIT
properties (TestParameter)
    promise = Roburoc4Test.promises()
end

methods (Test)
    function holds(testCase, promise)
        testCase.applyFixture(matlab.unittest.fixtures.PathFixture(Roburoc4Test.folder()));
        testCase.applyFixture(matlab.unittest.fixtures.PathFixture( ...
            fullfile(Roburoc4Test.folder(), '..', 'toolbox', 'examples')));
        feval(promise);
    end

    function simulinkDrivesACircle(testCase)
        testCase.assumeNotEmpty(ver('simulink'), 'there is no Simulink');
        testCase.assumeFalse(verLessThan('matlab', '9.10'), 'the block needs R2021a');
        simulink = fullfile(Roburoc4Test.folder(), '..', 'toolbox', 'simulink');
        testCase.applyFixture(matlab.unittest.fixtures.PathFixture(simulink));
        testCase.applyFixture(matlab.unittest.fixtures.WorkingFolderFixture());
        roburoc4_library();
        roburoc4_model();
        result = sim('roburoc4_circle', 'ReturnWorkspaceOutputs', 'on');
        steps = diff(result.pose(:, 1:2));
        path_m = sum(sqrt(sum(steps .^ 2, 2)));
        testCase.verifySize(result.pose, [401 3]);
        testCase.verifyEqual(path_m, 0.4 * 20, 'AbsTol', 1);
        testCase.verifySize(result.bumpers, [401 2]);
    end
end

methods (Static)
    function path = folder()
        path = fullfile(fileparts(mfilename('fullpath')), '..');
    end

    function names = promises()
        files = dir(fullfile(Roburoc4Test.folder(), 'test_*.m'));
        names = strrep({files.name}, '.m', '');
    end
end
end
