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
