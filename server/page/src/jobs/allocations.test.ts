import { expect, test } from "vitest";
import { counted } from "./allocations";

test("allocations are counted by state, with why they wait", () => {
  expect(counted([])).toBe("no allocations");
  const pending = (reason?: string) => ({ id: "1", state: "PENDING", reason });
  const running = { id: "2", state: "RUNNING" };
  expect(counted([running])).toBe("1 allocation: 1 running");
  expect(counted([running, pending("Priority"), pending("Resources"), pending("Priority")])).toBe(
    "4 allocations: 1 running, 3 pending (Priority, Resources)",
  );
});
