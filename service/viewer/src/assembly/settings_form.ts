// Numbers of the scene to be, each with what it is for. Where a scene is felt already they hold from the next time on.
import { element } from '../dom.js';
import type { Settings } from './draft.js';

export class SettingsForm {
  private readonly stiffness = element<HTMLInputElement>('set-stiffness');
  private readonly voxel = element<HTMLInputElement>('set-voxel');
  private readonly profile = element<HTMLSelectElement>('set-profile');
  private readonly law = element<HTMLSelectElement>('set-law');
  private readonly budget = element<HTMLInputElement>('set-budget');

  constructor(changed: (settings: Settings) => void) {
    for (const field of [this.stiffness, this.voxel, this.profile, this.law, this.budget]) field.addEventListener('change', () => {
      if (!field.checkValidity()) { field.reportValidity(); return; }
      changed({
        stiffness: this.stiffness.valueAsNumber || 2000, voxel_mm: this.voxel.value === '' ? null : this.voxel.valueAsNumber, profile: this.profile.value as Settings['profile'],
        law: this.law.value as Settings['law'], budget_us: Number.isFinite(this.budget.valueAsNumber) ? this.budget.valueAsNumber * 1000 : 4000,
      });
    });
  }
  show(settings: Settings): void {
    this.stiffness.value = String(settings.stiffness);
    this.voxel.value = settings.voxel_mm === null ? '' : String(settings.voxel_mm);
    this.profile.value = settings.profile;
    this.law.value = settings.law;
    this.budget.value = String(settings.budget_us / 1000);
  }
}
